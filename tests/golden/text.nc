; all that may stand around the words, and a real peculiarity: blocks in small letters
n10 g00 x+1. y-.5 (a remark) z = 2 ; and another
N20
/ X5
/2 X6
: 30
g1x2f0100z1.(MSG, look here)

G2 I-1
G1 X.75
Y0 N40
Q7
