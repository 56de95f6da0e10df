(dialect fanuc)
O1 (a program that calls itself)
M98 P1
