"""What Manual 001 states of its macro language, each statement by several macros, and in posted programs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from polycnc.errors import ConfigurationError
from polycnc.post import parse_control
from support.post_cases import TABLES, blocks_of, check_every_way, control_with, rows_of
from support.post_controls import control, control_text, posted

Case = tuple[str | tuple[str, ...], str, dict[str, Any]]
"""The macros of one program, the blocks that they write, and parameters or words (those in capitals)."""

NUMBERED: dict[str, Any] = {"sequence_place": 1}
MARKED: dict[str, Any] = {"sequence_place": 2}
ORDERED, ENDED = '<OUTPUTORDER=1><STARTOFLINE="s">', '<ENDOFLINE="e">'


def _six(operator: str, others: str, one: str, at: int) -> str:
    """Return an IF of six comparisons, of which the one at `at` decides."""
    return f"IF({operator.join(one if each == at else others for each in range(6))})\na\nELSE\nb\nENDIF"


ROWS: dict[str, list[Case]] = {
    "string.literal": [
        (("a b  C", "( x,y;z )", " %d{}\\n#[1]^~"), "a b  C|( x,y;z )| %d{}\\n#[1]^~", {}),
        ("aB!G00! 5 !*G90! x", "aBG00 5  x", {}),
    ],
    "string.special_chars": [
        ('"!"\n"$"\n"@"\n"&"\n"<"\n">"', "!|$|@|&|<|>", {}),
        ('A"!G00!$X$"!G00!"@1@&X&<V1=2>"', "A!G00!$X$G00@1@&X&<V1=2>", {}),
    ],
    "string.dquote": [
        ('a"b!c"d" e "', "ab!cd e ", {}),
        ('<OUTPUTORDER=1>!G00!"b"\'a,-1\'"c"', "abcG00", {}),
        ('"x,-200"!G00!"\'y,5\'"', "x,-200G00'y,5'", {}),
        ('"{a}"\'{b},0\'"{}%d"', "{a}{b}{}%d", {}),
    ],
    "string.squote": [
        ("<OUTPUTORDER=1>!G00!'b,9''c,11''a,-200'", "abG00c", {}),
        ("<OUTPUTORDER=1>'d,100''b,20''a,3''c,+99'", "abcd", {}),
        ("<OUTPUTORDER=1>!M06!'!<x>$&@\", 91 '!M03!' b ,-7'", ' b M06!<x>$&@"M03', {}),
        ("!G00!'a,-200'!G90!'b,,5'", "G00aG90b,", {}),
    ],
    "string.order_default": [
        ("<OUTPUTORDER=1>'a,1'b'c,-1'\"d\"!G00!", "cbdaG00", {}),
        ("<OUTPUTORDER=1>!G00!a$X$\"b\"'c,0'$COMMENT$", "abc-G00X2.500", {"X": 2.5, "COMMENT": "-"}),
    ],
    "order.written": [
        ("!M06!$X$b!G90!'a,-5'$F$!G00!", "M06X1.500bG90aF7G00", {"X": 1.5, "F": 7.0}),
        ("@1@!M03!a", "N10M03a", MARKED),
        (("<OUTPUTORDER=1>!M03!!G00!", "<OUTPUTORDER=0>!M03!!G00!"), "G00M03|M03G00", {}),
    ],
    "word.OUTPUTORDER": [
        (("!M03!$X$!G00!", "<OUTPUTORDER=1>", "!M03!$X$!G00!"), "M03X3.000G00|G00M03", {"X": 3.0}),
        ("<OUTPUTORDER=2>!M03!!G00!\n<OUTPUTORDER=3-2>!M03!!G00!", "M03G00|G00M03", {}),
        ("<OUTPUTORDER=1>!M09!!M05!$T$$S$$F$$Z$$Y$$X$!G91!!G28!!G01!b", "bG01G28G91X1.000Y2.000Z3.000F4S5T06M05M09",
         {"X": 1.0, "Y": 2.0, "Z": 3.0, "F": 4.0, "S": 5.0, "T": 6.0}),
        ("IF(OUTPUTORDER==0)\n<OUTPUTORDER=1>\nENDIF\n!M03!!G00!$OUTPUTORDER$", "1G00M03", {}),
    ],
    "order.sort": [
        ("<OUTPUTORDER=1>'e,1000''a,-20''d,100''c,2''b,-3'", "abcde", {}),
        ("<OUTPUTORDER=1>!G91!!G90!!G01!!G00!'x,20'", "G01G00G91G90x", {}),
        ("<OUTPUTORDER=1>@1@$F$'p,-99''q,-101'!M08!$X$", "qN10pX1.000F2M08", {**MARKED, "X": 1.0, "F": 2.0}),
    ],
    "code.output": [
        ("!G00!\n!G00!!G00!\n!M08!\n!M08!", "G00|G00G00|M08|M08", {}),
        ("!G01!\n!-G01!a\n!-G00!", "G01|a|G00", {}),
        ("!*M03!\n!M03!\n!-M03!b!M05!\n!-M03!", "M03|bM05|M03", {}),
        ("!G28!x!G28!", "G28xG28", {}),
    ],
    "code.star": [
        ("!*G91!!*M08!\n!-G91!!-M08!a\n!-G90!!-M09!", "a|G90M09", {}),
        ("!*G00!!*G01!b\n!-G01!c\n!-G00!", "b|c|G00", {}),
        ("!*G28!d!*M06!\n!-G28!!-M06!", "d|G28M06", {}),
        (("!*M05!", "!-M05!e", "!-M03!"), "e|M03", {}),
    ],
    "code.minus": [
        ("!-G91!\n!-G91!a\n!-G90!!-G90!\n!-G91!", "G91|a|G90|G91", {}),
        ("!-M03!!-G00!!-M08!\n!-M03!!-G01!!-M08!\n!-M05!!-G01!", "M03G00M08|G01|M05", {}),
        (("!-G00!", "IF(V1==0)\n!-G00!b\nENDIF\n!-G01!"), "G00|b|G01", {}),
        ("!G91!\n!*G90!\n!-G91!\n!-G91!\n!G90!\n!-G90!c", "G91|G91|G90|c", {}),
    ],
    "code.modal_state": [
        ("!G00!!*G91!!-M03!\n!-G00!!-G91!!-M03!a", "G00M03|a", {}),
        ("!-G01!\n!*G00!\n!-G01!\n!G00!\n!-G01!\n!-G01!b", "G01|G01|G00|G01|b", {}),
        (("!G90!", "!-M08!!-G90!", "!-M08!!-G90!!-G91!"), "G90|M08|G91", {}),
    ],
    "code.search_key": [
        ("!g00!!-G91!!*m03!!-m03!\n!m06!", "G00G91|M06", {}),
    ],
    "word.expand": [
        ("a$TOOLCHANGE$b$COMMENT$c$PATHNUMBER$d", "aT07 .b x! c12d", {"TOOLCHANGE": "T07 .", "COMMENT": " x! ",
         "PATHNUMBER": 12.0}),
        ("$toolchange$$Comment$", "T3=", {"TOOLCHANGE": "T3", "COMMENT": "="}),
        ("$COMMENT$$COMMENT$", "abab", {"COMMENT": "ab"}),
        ("$DWELL$a$DWELL$", "0a0", {"DWELL": -0.0000004}),
    ],
    "word.reserved": [
        ("($PARTNAME$/$MACHINENAME$/$UNITS$)$TOOLNAME$", "(P 1/M/21)c", {"PARTNAME": "P 1", "MACHINENAME": "M",
         "UNITS": 21.0, "TOOLNAME": "c"}),
        ("$PATHNAME$:$DWELL$<V1=DWELL*2>\nIF(V1==2.5)\n$PATHNUMBER$\nENDIF", "q:1.25|4",
         {"PATHNAME": "q", "DWELL": 1.25, "PATHNUMBER": 4.0}),
    ],
    "word.function_var": [
        ("<T=10>$T$\n<S=1234.6>$S$\n<F=0.125>$F$\n<X=-2>$X$", "T10|S1235|F0.125|X-2.000", {}),
        ("<t=5>a$t$b", "aT05b", {}),
        ("$X$\n<X=X-0.0001>$X$a\n<X=X-1>$X$", "X-2.500|a|X-3.500", {"X": -2.5}),
    ],
    "word.T": [
        ("<T=3>$T$\n<T=T+97>$T$", "T03|T100", {}),
        ("$T$\n$T$a\n&T&$T$", "T12|a|T12", {"T": 12.0}),
    ],
    "word.F": [
        ("$F$\n$F$a\n&F&$F$\n<F=F+0.5>$F$", "F250|a|F250|F250.5", {"F": 250.0}),
    ],
    "word.X": [
        ("$X$\n$X$a\n<X=X+1>$X$\n&X&$X$", "X4.500|a|X5.500|X0.000", {"X": 4.5, "Y": 9.0, "Z": 8.0}),
    ],
    "word.Y": [
        ("$Y$\n$Y$a\n<Y=Y+1>$Y$\n&Y&$Y$", "Y4.500|a|Y5.500|Y0.000", {"Y": 4.5, "X": 9.0, "Z": 8.0}),
    ],
    "word.Z": [
        ("$Z$\n$Z$a\n<Z=Z+1>$Z$\n&Z&$Z$", "Z4.500|a|Z5.500|Z100.000", {"Z": 4.5, "X": 9.0, "Y": 8.0}),
    ],
    "word.TOOLCHANGE": [
        ("@1@!M06!$TOOLCHANGE$\n$TOOLCHANGE$", "N10M06T5M6|T5M6", {**MARKED, "TOOLCHANGE": "T5M6"}),
        ("$TOOLCHANGE$", "T11", {"T": 11.0}),
    ],
    "seq.suppress": [
        ("!G00!\n@0@!G01!\n!G90!\n$X$@0@a\n!G91!", "N10G00|G01|N20G90|X1.500a|N30G91", {**NUMBERED, "X": 1.5}),
        ("@0@a\n@0@b", "a|b", NUMBERED),
        ("@0@a\n@0@@1@b\n@1@c", "a|b|N10c", MARKED),
    ],
    "seq.output": [
        ("a\n@1@b\nc@1@\n@0@d\n@1@!G00!", "a|N10b|N20c|d|N30G00", MARKED),
        ("a\n@1@b", "N10a|N20b", NUMBERED),
        ("a\n@1@b", "a|b", {"sequence_place": 0}),
        ("@1@ a\n@1@b@1@", "N10 a|N20b", MARKED),
        ("@1@a@1@\n@1@b", "N10a|N20b", NUMBERED),
    ],
    "seq.option2": [
        ("a\n@1@b\n!G00!$X$\nIF(X==1)\n@1@c\nd\nENDIF", "a|N10b|G00X1.000|N20c|d", {**MARKED, "X": 1.0}),
        ("@1@<V1=2>\n@1@!*G00!\n@1@e", "N10e", MARKED),
    ],
    "seq.conflict": [
        ("@1@@0@a\n@0@@1@b\n@1@c@0@\n@1@d", "a|b|c|N10d", MARKED),
        ("@1@@0@a\nb@0@@1@\nc", "a|b|N10c", NUMBERED),
    ],
    "block.sequence_number": [
        ("a\n!*G00!\nb\n@0@c\n<V1=1>\nd", "N10a|N20b|c|N30d", NUMBERED),
        (("a", "b\nc", "d"), "N7:a|N10:b|N13:c|N16:d", {**NUMBERED, "start": 7, "step": 3, "sequence_format": "N%d:"}),
        ("a\nb\nc\nd", "N010a|N030b|N010c|N030d", {**NUMBERED, "step": 20, "sequence_highest": 49,
         "sequence_format": "N%03d"}),
        ("a\nb", "a|b", {}),
    ],
    "block.empty": [
        ("!*G00!\n<V1=5>\n&F&\n!-G00!\na", "N10a", NUMBERED),
        ("$X$\n$X$\n!-G00!$X$\n!-G00!$X$\n&X&\n\n  \nb", "N10X2.500|N20G00|N30b", {**NUMBERED, "X": 2.5}),
        ("@1@<V1=1>&M03&!*M03!!-M03!\n@1@c", "N10c", MARKED),
        ("$COMMENT$\n$COMMENT$d", "d", {"COMMENT": ""}),
        ('<ENDOFLINE=";"><STARTOFLINE="/">\n!*G00!\ne', "/e;", {}),
    ],
    "expr.assign": [
        ("<V1=100+1><T=V1>$T$<V1=V1-91>\n<T=V1>$T$", "T101|T10", {}),
        ("a<V1=3>b<T=V1*V1>c$T$", "abcT09", {}),
        ("<X=5>$X$<X=X/4>\n$X$", "X5.000|X1.250", {}),
        ("<V1=2>\nIF(V1==2)\n<V1=7>\nENDIF\n<T=V1>$T$", "T07", {}),
        ("<T=11>\na", "a", {}),
    ],
    "op.assign": [
        ("<V1=3><V2=V1><V1=8><T=V1*10+V2>$T$", "T83", {}),
        ("< V1 = 4 >< T=V1 +1 >$T$", "T05", {}),
        ('<STARTOFLINE=" s "><ENDOFLINE=" e ">a', " s a e ", {}),
    ],
    "expr.newvar": [
        (("<AB_1=6.5>", "<AB_2=AB_1*2>", "<T=AB_2+AB_1*4>$T$"), "T39", {}),
        ("IF(1==2)\n<Q9=5>\nENDIF\n<T=Q9+3>$T$\n<Q9=8>\n<T=Q9+3>$T$", "T03|T11", {}),
        ("<DEPTHS=2><DEPTH=9><T=DEPTHS>$T$", "T02", {}),
    ],
    "expr.undefined": [
        ("<T=NONE*5+6>$T$<T=COS(NONE)+7>\n$T$", "T06|T08", {}),
        ("IF(NONE==0 && NONE<1 && NONE>-1)\na\nENDIF\n&X*NONE+2&$X$", "a|X2.000", {"X": 5.0}),
        ("<V1=NONE>\n<NONE=4>\n<T=V1+NONE>$T$", "T04", {}),
    ],
    "expr.case": [
        ("<Ab=2><aB=AB+3><t=ab>$T$\n<T=Dabs(-9)+sQrT(16)>$t$", "T05|T13", {}),
        ("<outputorder=1>!m03!!G00!\nIf(Outputorder==1)\n<startofline=\"a\">b\nEndIf", "G00M03|ab", {}),
        ("$f$\n&f&$F$\nif(f==30)\nx\nelse\nX\nendif", "F30|F30|x", {"F": 30.0}),
    ],
    "expr.number": [
        ("<F=100>$F$\n<F=0.5>$F$\n<F=.25>$F$\n<F=7.>$F$\n<F=12.0625>$F$", "F100|F0.5|F0.25|F7|F12.0625", {}),
        ("<X=1234.567>$X$\n<X=007>$X$\nIF(X==7.00)\na\nENDIF", "X1234.567|X7.000|a", {}),
    ],
    "expr.string_value": [
        ('<STARTOFLINE="<a, b>">x\n<ENDOFLINE="!$&">y\n<STARTOFLINE="1">z', "<a, b>x|<a, b>y!$&|1z!$&", {}),
        (('<ENDOFLINE="E">', "a", "b<ENDOFLINE=\"\">\nc"), "aE|b|c", {}),
    ],
    "word.STARTOFLINE": [
        (('<STARTOFLINE="/ ">a\nb', "$X$\n$X$\n!-G00!", "<STARTOFLINE=\"\">c"), "/ a|/ b|/ X1.500|/ G00|c",
         {"X": 1.5}),
        ('<STARTOFLINE="s">a\n@0@b', "sN10a|sb", NUMBERED),
        ('<STARTOFLINE="s"><OUTPUTORDER=1>!M03!!G00!\'a,-200\'', "saG00M03", {}),
    ],
    "word.ENDOFLINE": [
        (('<ENDOFLINE=" ;*">a\nb', "$X$\n$X$\n!-G00!", "<ENDOFLINE=\"\">c"), "a ;*|b ;*|X1.500 ;*|G00 ;*|c",
         {"X": 1.5}),
        ('<ENDOFLINE="e">a\n@0@b', "N10ae|be", NUMBERED),
        ('<ENDOFLINE=";">$X$!-G00!\n$X$!-G00!!G90!\n$X$$Y$', "X1.500 G00;|G90;|Y2.000;",
         {"X": 1.5, "Y": 2.0, "separator": " "}),
        ('<STARTOFLINE="/"><ENDOFLINE=";">$X$!-G00!\n$X$$Y$', "/X1.500 G00;|/Y2.000;",
         {"X": 1.5, "Y": 2.0, "separator": " "}),
        ('<ENDOFLINE="e"><OUTPUTORDER=1>!M03!!G00!\'a,200\'', "G00M03ae", {}),
    ],
    "init.key": [
        ("$F$$S$\n&F&$F$$S$\n$F$$S$a\n&S&\n$F$$S$", "F5S6|F5|a|S6", {"F": 5.0, "S": 6.0}),
        ("!G90!!M03!!G00!\n&G90&!-G90!!-M03!!-G00!\n&M03&\n!-M03!!-G90!", "G90M03G00|G90|M03", {}),
        ("!G91!\n&g90&!-G91!\n&G28&!-G91!b", "G91|G91|b", {}),
        (("!-G00!$X$", "&G00&", "!-G00!$X$"), "G00X2.000|G00", {"X": 2.0}),
    ],
    "init.xyz": [
        ("$X$$Y$$Z$\n&X&\n$X$$Y$$Z$\n&Y&$Y$\n&Z&$Z$", "X1.000Y2.000Z3.000|X0.000|Y0.000|Z100.000",
         {"X": 1.0, "Y": 2.0, "Z": 3.0}),
        ("$F$$S$$T$\n&F&&S&&T&$F$$S$$T$", "F5S6T07|F5S6T07", {"F": 5.0, "S": 6.0, "T": 7.0}),
        ("&X&&Y&&Z&$X$$Y$$Z$\n$X$$Y$$Z$a", "X-4.500Y0.125Z60.000|a", {"X": 1.0, "Y": 2.0, "Z": 3.0,
         "origin": "X = -4.5, Y = 0.125, Z = 60.0"}),
        ("<V1=X>&X&<V2=X><T=V1*10+V2>$T$", "T25", {"X": 2.0, "origin": "X = 5.0"}),
    ],
    "init.value": [
        ("$X$$F$\n&X*7.25&&F*8&$X$$F$\n&X*-X*2&$X$", "X1.000F2|X7.250F8|X-14.500", {"X": 1.0, "F": 2.0}),
        ("$Z$\n&Z*Z&$Z$\n&Z*9-5&$Z$\n$Z$a", "Z3.000|Z3.000|Z4.000|a", {"Z": 3.0}),
        ("<V1=6>&s*V1/4+0.5&$S$\n<T=S>$T$", "S2|T02", {}),
        ("&X*7 &&F* -V1-2 &$X$$F$", "X7.000F-2", {}),
    ],
    "if.statement": [
        ("IF(X==1)\na\nb\nELSE IF(X==1)\nc\nELSE\nd\nENDIF\ne", "a|b|e", {"X": 1.0}),
        ("IF(X==2)\na\nELSE IF(X==1)\nb\nELSE IF(X<9)\nc\nELSE\nd\nENDIF", "b", {"X": 1.0}),
        ("IF(X==2)\nIF(X==1)\na\nELSE\nb\nENDIF\nELSE\nc\nENDIF\nIF(X==2)\nd\nENDIF", "c", {"X": 1.0}),
        ("  IF (X==1)\n  a\n  ENDIF", "  a", {"X": 1.0}),
    ],
    "if.else_if": [
        ("IF(X==2)\na\nELSE IF(X==3)\nb\nELSE IF(X==1)\nc\nELSE IF(X==1)\nd\nENDIF", "c", {"X": 1.0}),
        ("IF(X==2)\na\nELSE IF(X==3 || X==1)\nb\n<X=7>\nELSE IF(X==7)\nc\nELSE\nd\nENDIF", "b", {"X": 1.0}),
        ("IF(X==2)\na\nELSE IF(X==3)\nb\nENDIF\ne", "e", {"X": 1.0}),
        ("IF(X==0)\n" + "ELSE IF(X==5)\na\n" * 14 + "ELSE IF(X==1)\nb\nENDIF", "b", {"X": 1.0}),
        ("IF(X==2)\na\nelse \t IF(X==3)\nb\n\tELSEIF (X==1)\nc\nENDIF", "c", {"X": 1.0}),
    ],
    "if.else": [
        ("IF(X==2)\na\nELSE\nb\nc\nENDIF\nd", "b|c|d", {"X": 1.0}),
        ("IF(X==1)\na\nELSE\nb\nENDIF", "a", {"X": 1.0}),
        ("IF(X==2)\na\nELSE IF(X==1)\nb\nELSE\nc\nENDIF", "b", {"X": 1.0}),
        ("if(X==2)\na\nElse If(X==3)\nb\nelse\nc\nEndif\nd", "c|d", {"X": 1.0}),
    ],
    "if.endif": [
        ("IF(X==2)\na\nENDIF\nb\nIF(X==1)\nc\nENDIF\nd", "b|c|d", {"X": 1.0}),
        ("IF(X==1)\nIF(X==2)\na\nENDIF\nb\nENDIF\nc", "b|c", {"X": 1.0}),
        ("IF(X==2)\na\nEndIf\nIF(X==1)\nb\nendif \t\nc", "b|c", {"X": 1.0}),
    ],
    "if.nesting": [
        ("IF(X==1)\n" * 10 + "a\n" + "ENDIF\n" * 10 + "b", "a|b", {"X": 1.0}),
        ("IF(X==2)\nELSE\n" * 10 + "c\n" + "ENDIF\n" * 10, "c", {"X": 1.0}),
        ("IF(X==1)\n" * 9 + "IF(X==1)\na\nENDIF\n" * 2 + "ENDIF\n" * 9, "a|a", {"X": 1.0}),
    ],
    "if.operands": [
        ("IF(X*2+Y/4-1==9.5 && PATHNUMBER==3)\na\nENDIF", "a", {"X": 5.0, "Y": 2.0, "PATHNUMBER": 3.0}),
        ("IF(7-X*2<-X+2.5 && -X==-5 && (X+1)*2==12)\nb\nENDIF", "b", {"X": 5.0}),
        ("IF(F/3==X+Y*2)\nc\nELSE\nd\nENDIF\nIF(8-3-2==X-2)\ne\nENDIF", "c|e", {"F": 27.0, "X": 5.0, "Y": 2.0}),
    ],
    "if.condition": [
        ("IF(X==1 && Y==2 || Z==4 && F==9)\na\nENDIF\nIF(X==9 && Y==2 || Z==3 && F==4)\nb\nENDIF", "a|b",
         {"X": 1.0, "Y": 2.0, "Z": 3.0, "F": 4.0}),
        ("IF(X==9 || Y<2 || Z>=3)\na\nENDIF\nIF(X!=1 || Y>2 && Z==3)\nb\nENDIF\nc", "a|c",
         {"X": 1.0, "Y": 2.0, "Z": 3.0}),
    ],
    "logic.and": [
        ("IF(X==1&&Y==2&&Z==3)\na\nENDIF\nIF(X==1&&Y==3)\nb\nENDIF\nIF(X==2&&Y==2)\nc\nENDIF\nd", "a|d",
         {"X": 1.0, "Y": 2.0, "Z": 3.0}),
        *((_six("&&", "X==1", "X==9", at), "b", {"X": 1.0}) for at in range(6)),
        (_six("&&", "X==1", "X==1", 0), "a", {"X": 1.0}),
    ],
    "logic.or": [
        *((_six("||", "X==9", "X==1", at), "a", {"X": 1.0}) for at in range(6)),
        (_six("||", "X==9", "X==9", 0), "b", {"X": 1.0}),
        ("IF(X==1||Y==9)\na\nENDIF\nIF(X==9||Y==2)\nb\nENDIF\nIF(X==2||Y==1)\nc\nENDIF\nIF(X==1||Y==2)\nd\nENDIF",
         "a|b|d", {"X": 1.0, "Y": 2.0}),
    ],
    "logic.limit": [
        ("IF(X==2||X==3||X==4||X==5||X==6||X==1)\na\nENDIF\nIF(X==1&&X<2||X==3&&X==4||X==6&&X==1)\nb\nENDIF", "a|b",
         {"X": 1.0}),
        ("IF(X==2)\na\nELSE IF(X==2||X==3||X==4||X==5||X==6||X==1)\nb\nENDIF", "b", {"X": 1.0}),
    ],
    "macro.line_is_block": [
        ("!G90!!G00!$X$a\n!G91!\n\nb", "G90G00X2.000a|G91|b", {"X": 2.0}),
        (("a\nb", "c", "d\ne"), "a|b|c|d|e", {}),
    ],
    "macro.elements": [
        ("a'b,-9'!G00!$X$@0@<V1=1>&F&\n@1@$F$\nIF(V1==1)\nc\nENDIF", "abG00X1.500|N10F2|N20c",
         {**NUMBERED, "X": 1.5, "F": 2.0}),
        *((f"IF(X==1)\na\nELSE IF(X==2)\n{ORDERED}\nELSE\n{ENDED}\nENDIF\n!M03!!G00!", blocks, {"X": x})
          for x, blocks in ((1.0, "a|M03G00"), (2.0, "sG00M03"), (3.0, "M03G00e"))),
    ],
    "section.nc_macro": [
        (("a", "!G00!\nb", "$X$", "c\nd"), "a|G00|b|X3.000|c|d", {"X": 3.0}),
        (("#1=5\n;x\n//y", "%\n[a]", "=z\n-"), "#1=5|;x|//y|%|[a]|=z|-", {}),
    ],
    "concept.multi_path": [
        (("!-G01!$X$$F$", "@0@!M06!", "!-G01!$X$$F$"), "G01X1.000F9|M06", {"X": 1.0, "F": 9.0}),
        (("!-G01!$X$$F$", "&F&!M06!", "!-G01!$X$$F$"), "G01X1.000F9|M06|F9", {"X": 1.0, "F": 9.0}),
    ],
    "concept.machining_origin": [
        ("$X$$Y$$Z$", "X5.000Y-2.500Z70.000", {"origin": "X = 5.0, Y = -2.5, Z = 70.0"}),
        ("&X&&Z&&F&$X$$Y$$Z$$F$", "X5.000Y2.000Z70.000F8", {"F": 8.0, "X": 1.0, "Y": 2.0, "Z": 3.0,
         "origin": "X = 5.0, Y = -2.5, Z = 70.0"}),
        ("&X&&Y&&Z&$X$$Y$$Z$", "X0.000Y0.000Z0.000", {"origin": "", "X": 1.0, "Y": 2.0, "Z": 3.0}),
    ],
}  # fmt: skip


def _cases() -> Iterator[Any]:
    for row, cases in ROWS.items():
        for place, case in enumerate(cases, 1):
            macros, _, given = case
            each = (macros,) if isinstance(macros, str) else macros
            shown = rows_of(*each, place=given.get("sequence_place", 0))
            yield pytest.param(
                *case,
                id=f"{row}-{place}",
                marks=pytest.mark.covers(*{f"post.{row}": 0, **dict.fromkeys(shown)}),
            )


@pytest.mark.parametrize(("macros", "blocks", "given"), list(_cases()))
def test_macros_write_what_the_manual_states(
    macros: str | tuple[str, ...], blocks: str, given: dict[str, Any]
) -> None:
    each = (macros,) if isinstance(macros, str) else macros
    words = {name: value for name, value in given.items() if name.isupper()}
    parameters = {name: value for name, value in given.items() if name.startswith("se")}
    tables = _tables(given)
    assert blocks_of(*each, words=words, tables=tables, **parameters) == blocks.split("|")
    check_every_way(*each, words=words, tables=tables, **parameters)


def _tables(given: dict[str, Any]) -> str:
    """Return the tables of the worked cases with another origin, first number or step."""
    tables = TABLES.replace("X = 0.0, Y = 0.0, Z = 100.0", given.get("origin", "X = 0.0, Y = 0.0, Z = 100.0"))
    tables = tables.replace("sequence_start = 10", f"sequence_start = {given.get('start', 10)}")
    return tables.replace("sequence_step = 10", f"sequence_step = {given.get('step', 10)}")


NEAR = 0.0000999
FAR = 0.0001001
HOLDS = {
    "equal": ("==", (False, True, True, True, False)),
    "not_equal": ("!=", (True, False, False, False, True)),
    "less": ("<", (True, False, False, False, False)),
    "less_or_equal": ("<=", (True, True, True, True, False)),
    "greater": (">", (False, False, False, False, True)),
    "greater_or_equal": (">=", (False, True, True, True, True)),
}


@pytest.mark.parametrize(
    ("operator", "holds"),
    [
        pytest.param(*each, marks=pytest.mark.covers(f"post.cond.{row}", "post.cond.tolerance"))
        for row, each in HOLDS.items()
    ],
)
def test_the_tolerance_is_absolute_and_holds_for_all_numbers(operator: str, holds: tuple[bool, ...]) -> None:
    control = control_with(
        {"RAPID": f"IF(X{operator}Y)\nyes\nELSE\nno\nENDIF\nIF(Y+2>9 || X+Z{operator}Y+Z)\nalso\nENDIF"}
    )
    written: list[str] = []
    run = control.start(written.append)
    for base in (-12.25, -0.00002, 0.0, 7.0, 4000.5):
        for difference, wanted in zip((-FAR, -NEAR, 0.0, NEAR, FAR), holds, strict=True):
            run.call("RAPID", {"X": base + difference, "Y": base, "Z": -base})
            also = ["also\n"] * (wanted or base > 7)
            assert [written.pop(0) for _ in range(len(written))] == ["yes\n" if wanted else "no\n", *also]
    for difference, like in ((-0.0001, holds[0]), (0.0001, holds[-1])):  # no smaller difference: not equal
        run.call("RAPID", {"X": difference, "Y": 0.0, "Z": 3.0})
        assert written.pop(0) == ("yes\n" if like else "no\n")
        written.clear()


REFUSED = [
    ("if.nesting", "IF(1==1)\n" * 11 + "ENDIF\n" * 11, "IFs are nested more than 10 deep"),
    ("if.nesting", "IF(1==1)\nELSE\n" * 11 + "ENDIF\n" * 11, "IFs are nested more than 10 deep"),
    ("logic.limit", "IF(1==1)\nELSE IF(1==1||1==1||1==1||1==1||1==1||1==1||1==1)\nENDIF", "more than 5 logical"),
    ("logic.limit", "IF(1==1||1==1&&1==1||1==1&&1==1||1==1&&1==1)\nENDIF", "more than 5 logical"),
    ("if.condition", "IF(1==1 && )\nENDIF", "a number or a variable is missing"),
    ("if.condition", "IF(1==1 2==2)\nENDIF", "')' is missing"),
    ("op.assign", "<V1+1=2>", "< begins no assignment"),
    ("op.assign", "<1=2>", "< begins no assignment"),
    ("op.assign", "<V1=>", "a number or a variable is missing"),
    ("op.assign", "<V1=2", "the assignment has no end"),
    ("expr.string_value", '<V1="a">', "V1 does not take a text"),
    ("expr.string_value", "<ENDOFLINE=a>", "ENDOFLINE takes a text in double quotes"),
    ("word.STARTOFLINE", "<STARTOFLINE=5>", "STARTOFLINE takes a text in double quotes"),
    ("word.ENDOFLINE", "<ENDOFLINE=;>", "ENDOFLINE takes a text in double quotes"),
    ("word.ENDOFLINE", "<ENDOFLINE='a'>", "ENDOFLINE takes a text in double quotes"),
    ("string.special_chars", ">a>", "> ends nothing here"),
    ("string.special_chars", "a@b", "@ begins neither @0@ nor @1@"),
    ("string.squote", "'/'", "ends with a comma and its place in the order"),
    ("string.squote", "'/,x'", "ends with a comma and its place in the order"),
    ("string.dquote", '"abc', "has no end"),
    ("code.output", "!M77!", "there is no code M77"),
    ("code.star", "!*M77!", "there is no code M77"),
    ("code.minus", "!-M77!", "there is no code M77"),
    ("code.search_key", "!X!", "there is no code X"),
    ("word.expand", "$G00$", "G00 is a code, not a word"),
    ("word.reserved", "<PARTNAME=5>", "PARTNAME is a text"),
    ("word.function_var", "<H1=5>$H1$", "there is no word H1"),
    ("init.key", "&V1&", "there is no code or function variable V1"),
    ("init.value", "&M03*2&", "M03 is a code and has no value"),
    ("seq.output", "@2@a", "@ begins neither @0@ nor @1@"),
    ("seq.suppress", "@00@a", "@ begins neither @0@ nor @1@"),
    ("if.else_if", "IF(1==1)\nELSE\nELSE IF(1==1)\nENDIF", "an ELSE came before"),
    ("if.endif", "IF(1==1)\nIF(1==1)\nENDIF", "the IF has no ENDIF"),
    ("if.statement", "IF(1==1)\na", "the IF has no ENDIF"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("macro", "what"),
    [pytest.param(macro, what, marks=pytest.mark.covers(f"post.{row}")) for row, macro, what in REFUSED],
)
def test_macros_that_the_manual_does_not_allow_are_refused(macro: str, what: str) -> None:
    with pytest.raises(ConfigurationError) as error:
        control_with({"LINEAR": macro})
    assert what in error.value.what


PATH = """PARTNO PLATE 7
MACHIN/MILL7,1
TOOL PATH/FIRST,TOOL,CUTTER_10
LOADTL/3
RAPID
GOTO/1.5,-2.25,30
FEDRAT/300,MMPM
GOTO/1.5,-2.25,-4
GOTO/11,-2.25,-4
GOTO/11,8.125,-4
END-OF-PATH
TOOL PATH/SECOND,TOOL,DRILL_4
LOADTL/12
RAPID
GOTO/11,8.125,30
FEDRAT/300,MMPM
GOTO/11,8.125,-6
FINI
"""
WORDS = {
    "PROGRAM_START": "($PARTNAME$ $MACHINENAME$ $UNITS$)",
    "PATH_START": "($PATHNAME$ $PATHNUMBER$)",
    "TOOL_CHANGE": "&X&&Y&&Z&&F&!M06!$TOOLCHANGE$($TOOLNAME$)\n&T&$T$",
    "PROGRAM_END": "!M30!",
}


@pytest.mark.covers(
    *("post.word.reserved", "post.word.expand", "post.word.TOOLCHANGE", "post.word.T", "post.word.F"),
    *("post.word.X", "post.word.Y", "post.word.Z", "post.word.function_var", "post.init.key"),
    *("post.macro.tool_change", "post.concept.multi_path", "post.section.nc_macro", "post.code.minus"),
    *("post.code.modal_state", "post.sec.nc_code", "post.sec.function_var"),
)
def test_a_posted_program_has_what_its_words_stand_for() -> None:
    blocks, _ = posted(PATH, control(macros=WORDS))
    assert blocks == [
        "(PLATE 7 MILL7 21)",
        "(FIRST 1)",
        "M06T3(CUTTER_10)",
        "T3",
        "G00X1.500Y-2.250Z30.000",
        "G01Z-4.000F300.000",
        "X11.000",
        "Y8.125",
        "(SECOND 2)",
        "M06T12(DRILL_4)",
        "T12",
        "G00X11.000Y8.125Z30.000",
        "G01Z-6.000F300.000",
        "M30",
    ]


@pytest.mark.covers("post.word.TOOLCHANGE", "post.word.T", "post.word.function_var", "post.word.expand")
def test_a_posted_tool_change_has_the_number_in_the_format_of_its_word() -> None:
    text = control_text({"sequence_place": 2}, {"TOOL_CHANGE": "@1@!M06!$TOOLCHANGE$\n&T&$T$"})
    for form, three, twelve in (
        ("T%02d", "T03", "T12"),
        ("Q%d.", "Q3.", "Q12."),
        ("T0%03d", "T0003", "T0012"),
    ):
        blocks, _ = posted(PATH, parse_control(text.replace("T%d", form)))
        assert [each for each in blocks if "M06" in each or each[0] in "TQ"] == [
            f"N10M06{three}", three, f"N20M06{twelve}", twelve,
        ]  # fmt: skip


@pytest.mark.covers("post.macro.tool_change", "post.word.TOOLCHANGE", "post.word.T")
def test_each_tool_of_a_path_is_changed_by_the_macro() -> None:
    tools = (1, 2, 30, 104, 1)
    path = "FEDRAT/300\n" + "".join(f"LOADTL/{tool}\nGOTO/{at},0,0\n" for at, tool in enumerate(tools))
    blocks, _ = posted(path, control(macros={"TOOL_CHANGE": "!M06!$TOOLCHANGE$"}))
    assert [each for each in blocks if "M06" in each] == [f"M06T{tool}" for tool in tools]


@pytest.mark.covers("post.seq.suppress", "post.seq.output", "post.seq.option2", "post.block.sequence_number")
@pytest.mark.covers("post.concept.multi_path", "post.sec.parameter")
def test_a_posted_program_is_numbered_where_its_macros_say_so() -> None:
    macros = {**WORDS, "TOOL_CHANGE": "@1@!M06!$TOOLCHANGE$", "LINEAR": "@0@!-G01!$X$$Y$$Z$"}
    for place, numbered in ((0, {}), (2, {"M06T3": 10, "M06T12": 20})):
        wanted = [f"N{numbered[block]}{block}" if block in numbered else block for block in
                  ("(PLATE 7 MILL7 21)", "(FIRST 1)", "M06T3", "G00X1.500Y-2.250Z30.000", "G01Z-4.000", "X11.000",
                   "Y8.125", "(SECOND 2)", "M06T12", "G00Z30.000", "G01Z-6.000", "M30")]  # fmt: skip
        assert posted(PATH, control({"sequence_place": place}, macros))[0] == wanted
    every = posted(PATH, control({"sequence_place": 1, "sequence_step": 5}, macros))[0]
    assert every[3:7] == ["N25G00X1.500Y-2.250Z30.000", "G01Z-4.000", "X11.000", "Y8.125"]
    assert every[7:9] == ["N30(SECOND 2)", "N35M06T12"]


@pytest.mark.covers(
    "post.sec.nc_code", "post.sec.g_code", "post.sec.m_code", "post.sec.parameter", "post.sec.function_var"
)
@pytest.mark.covers("post.file.output_control_file", "post.code.search_key", "post.order.sort")
def test_each_section_says_its_part_of_a_block() -> None:
    text = """
[parameters]
sequence_place = 1
sequence_start = 4
sequence_step = 3
sequence_format = "L%02d"
separator = " "
[nc_code]
SEQUENCE_NUMBER = { order = 15 }
go = { code = "G7", order = 20 }
STAY = { order = 10 }
COOL = { code = "M88", order = 1 }
X = { order = 18 }
F = { order = 30 }
[g_code]
GO = { group = "a" }
Stay = { group = "a" }
[m_code]
COOL = { group = "a" }
[function_variables]
X = { format = "A%.1f", zeros = "trim", scale = 2.0 }
F = { format = "S%d", modal = false, initial = 44.0 }
[nc_macros]
LINEAR = '''
!-GO!!-COOL!$F$$X$
<OUTPUTORDER=1>$F$!-GO!!STAY!!-COOL!$X$x
!-GO!'y,19'
'''
"""
    written: list[str] = []
    run = parse_control(text).start(written.append)
    run.call("LINEAR", {"X": 1.25})
    assert written == ["L04 G7 M88 S44 A2.5\n", "x Stay L07 S44\n", "L10 y G7\n"]


@pytest.mark.covers("post.sec.nc_code", "post.sec.g_code", "post.sec.m_code", "post.code.modal_state")
def test_a_code_without_text_has_its_mode_and_groups_are_told_apart_by_their_whole_names() -> None:
    text = """
[nc_code]
SET = { code = "" }
[g_code]
SET = { group = "motion_1" }
MOVE = { group = "motion_2" }
[m_code]
M1 = { group = "motion_1" }
M2 = { group = "motion_2" }
[nc_macros]
LINEAR = "!-SET!!-MOVE!a\\n!-SET!!-MOVE!b\\n!-M1!!-SET!!-MOVE!c\\n!-M2!!-M1!!SET!"
"""
    written: list[str] = []
    parse_control(text).start(written.append).call("LINEAR")
    assert written == ["MOVEa\n", "b\n", "M1c\n", "M2\n"]


@pytest.mark.covers(
    "post.init.xyz", "post.concept.machining_origin", "post.sec.function_var", "post.sec.parameter"
)
def test_an_axis_begins_with_its_first_value_and_goes_to_the_origin() -> None:
    tables = TABLES.replace('X%.3f"', 'X%.3f", initial = 8.0').replace('Y%.3f"', 'Y%.3f", modal = false')
    tables = tables.replace("X = 0.0, Y = 0.0", "X = -5.0, Y = 2.5")
    blocks = blocks_of("$X$$Y$$Z$\n<Y=7>$Y$\n&X&&Y&$X$$Y$\n$X$$Y$", tables=tables)
    assert blocks == ["X8.000Y2.500Z100.000", "Y7.000", "X-5.000Y2.500", "Y2.500"]


@pytest.mark.covers("post.word.F", "post.word.function_var")
@pytest.mark.parametrize(
    ("units", "minute", "turn"), [("mm", "250.000", "0.500"), ("inch", "9.843", "0.020")]
)
def test_a_feed_has_the_units_of_the_program(units: str, minute: str, turn: str) -> None:
    used = control({"units": units}, {"LINEAR": "$F$/$FEEDMODE$"})
    blocks, _ = posted("FEDRAT/250,MMPM\nGOTO/1,0,0\nSPINDL/RPM,500,CLW\nFEDRAT/0.5,MMPR\nGOTO/2,0,0\n", used)
    assert [block for block in blocks if block[0] == "F"] == [f"F{minute}/94", f"F{turn}/95"]
