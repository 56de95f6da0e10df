(dialect fanuc)
%
O1 (calls in the file, into another file, nested, repeated)
G91 G0 X1.
M98 P0100 L2
M98 P30101
M98 P200
/ X50.
G90 X0.
M30
O0100 (a row)
Y1.
M98 P101
M99
O0101
Z1.
M99
%
