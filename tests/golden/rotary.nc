(Axes in degrees: with ends, and with positions that repeat)
G0 A90 C350
C10
C190
C-170
G91 C400
G90 C0
F360 G1 A45
X10 A0
G20 A10
X0 A0
G92 C90
C100
G28 C0
