(dialect bosch)
F100
N20 G2 X10 Y10
