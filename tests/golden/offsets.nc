(Program zero: work offsets, G92, machine coordinates, the way home)
G0 X0 Y0 Z0
G55 X0 Y0 Z0
X5
G92 X0
X5
G92.1
X5
G54 X5
G91 X1
G90 G53 X1 Z1
X1
G28 X20 Z0
G91 G28 Z0
G28
