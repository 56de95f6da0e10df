%
O0200 (in a file of its own; it finds the programs of the main file)
X5.
M98 P101
M99
%
