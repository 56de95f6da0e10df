G1 X5 F100 rough cut
