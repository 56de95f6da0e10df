"""The prose of the reference page of control files; the tables between come from the code."""

from __future__ import annotations

INTRODUCTION = """\
# Control files for the post-processor

A control file says how the program of a control is written: its codes and their texts, the formats of its numbers, and
a macro for each event of a tool path. It is a [TOML](https://toml.io) file in UTF-8 or Shift-JIS. A key that is not on
this page is an error, and so is a line of a macro that cannot be meant. All of a file is checked before anything is
written; an error names the file, the section, the macro, the line and the column:

```text
{error}
```

The macro language is that of Manual 001. These control files come with polycnc; each is a place to begin:"""

AFTER_SECTIONS = """\
The manual's names, in quotes as TOML wants them (`["NCマクロ部"]`), may stand instead of the English ones. Search keys
begin with a letter; they and all names in macros mean the same in capitals and small letters. A search key is used
once in the whole file."""

MISTAKEN = """\
[g_code]
G01 = {}

[nc_macros]
LINEAR = '''
IF(FEEDMODE==94)
  !-G10!
ENDIF
'''
"""
"""A control file with the error that the introduction shows."""

ENTRIES = {
    "parameters": "Plain values. The first group says how moves are made, the second what blocks look like.",
    "five_axis": """\
A machine that turns the tool axis by two rotary axes. Of all positions of the two that give a tool axis within their
limits the nearest are taken; where the tool axis lies along the first axis, that one stays. None is an error, a feed
move that turns an axis by more than 90 degree is remarked.

With `output = "machine"` a feed move that turns the tool axis is cut into pieces, so that the tip stays within
`tolerance_mm` of its line although the machine moves its axes in proportion; arcs become lines, and holes moves, unless
the rotary axes stand at 0. A head needs the length of the tool, from the tool path. `fanuc-5axis` is an example.""",
    "rotary_axis": "Two of them, in their order from the part to the tool.",
    "nc_code": """\
One entry for each search key of a code, function variable or reserved word that needs one, like
`G00 = { code = "G0", order = 10 }`; `SEQUENCE_NUMBER` stands for the sequence number, whose order is -100 without an
entry. To change what a control reads, change it here: macros name only the search key.""",
    "codes": """\
One entry for each code that macros name, like `G01 = { group = "motion" }` or `G28 = {}`. Groups of G codes and of M
codes are apart.""",
    "function_variables": """\
One entry for each number that is written, like `X = { format = "X%.3f" }`. `%.3f` has three decimals, `%d` none
(rounded), `%g` up to six digits that count, without an exponent. Between `%` and the letter may stand `+` (write the
sign always), `0` and a width. Zero never has a minus.""",
    "nc_macros": """\
One text for each event that writes something, in `'''` quotes so that nothing in it needs a backslash:

```toml
[nc_macros]
TOOL_CHANGE = '''
&F&
@1@$TOOLCHANGE$!M06!
'''
```

An event without a macro writes nothing; see [events](post-events.md) for the names and the words that each sets. Every
line of a macro becomes a block of the program, if it writes anything. State lasts from macro to macro and from path
to path to the end of the program: the modes of all groups, what was written last of each function variable, all
variables, OUTPUTORDER, STARTOFLINE, ENDOFLINE and the sequence number.""",
}

ELEMENTS = """\
A line is read from left to right. Each element acts when it is reached.

| element | written | what it does |
| --- | --- | --- |
| text | `(TOOL CHANGE)` | written as it stands, with blanks; not with `! $ @ & < > " '` |
| quoted text | `"A<B & C"` | written without the quotes; here `! $ @ & < >` are possible |
| ordered text | `'/,-200'` | the text `/`, with the order -200 in place of 0 |
| code | `!G01!` | written always; its mode is in force |
| silent code | `!*G01!` | not written; its mode is in force |
| modal code | `!-G01!` | written unless its mode is in force already |
| word | `$PARTNAME$` | the text or number of a reserved word |
| function variable | `$X$` | the number in its format; nothing if it is modal and the same as last time |
| no number | `@0@` | the block gets no sequence number |
| number | `@1@` | the block gets one, with `sequence_place = 2`; with `@0@` in the block too it gets none |
| assignment | `<V1=100+1>` | sets a function variable, OUTPUTORDER or a variable of that name |
| line text | `<STARTOFLINE="/">`, `<ENDOFLINE=";">` | text before and after every block from now on; `""` for none |
| initialisation | `&F&`, `&G01&` | the next output is not omitted; of a code, its whole group has no mode |
| the same with a value | `&X*0&` | also sets the variable; without a value X, Y, Z go to the machining origin |

`<OUTPUTORDER=1>` makes the parts of a block come out by their `order` in `[nc_code]`, the smaller first, equals as
written; text has 0. `<OUTPUTORDER=0>` is back to the written order. What is set at the end of the line counts for all
of it.

Reserved words are OUTPUTORDER, STARTOFLINE, ENDOFLINE and the words that [events](post-events.md) set. TOOLCHANGE is
T in its format if the event gives no text. A word with a number that is no function variable is written with up to
six decimals. Words of one letter (X, F, ...) are written only as function variables."""

LANGUAGE = """\
## Expressions

Numbers, variables, `+ - * /` with the usual precedence, a sign, parentheses (up to {parentheses} inside each other) and
functions. A variable that nothing has set is 0. There is no exponent notation.

| function | is | function | is |
| --- | --- | --- | --- |
| `SIN(v)` `COS(v)` `TAN(v)` | of v in radians | `EXP(v)` | e to the power of v |
| `ASIN(v)` `ACOS(v)` `ATAN(v)` | in radians | `LOG(v)` `LOG10(v)` | logarithm to base e, to base 10 |
| `DEG(v)` | radians in degrees | `DMS(v)` | degrees packed as D.MMSS: 12.5 is 12.30 |
| `RAD(v)` | degrees in radians | `ADMS(v)` | the degrees of a packed angle |
| `SQRT(v)` | square root | `DABS(v)` | without its sign |

Division by zero, a root or logarithm of a number that has none, and a number too large to hold end the run with an
error at the place in the macro; no file is written then.

## IF

```text
IF(PLANE==18 && SWEEP>90)
...
ELSE IF(PLANE==19)
...
ELSE
...
ENDIF
```

Each stands in a line of its own and may be indented. A condition is comparisons of two expressions (`== != < <= > >=`),
joined by up to {operators} `&&` and `||`; `&&` binds closer. Numbers that differ by less than {equal} are equal: then
`== <= >=` hold and `!= < >` do not. IFs may be nested {nested_ifs} deep. Lines of branches that do not run have no
effect at all. A line of text that begins with one of these words goes in quotes."""

RULINGS = [
    ("OUTPUTORDER, STARTOFLINE, ENDOFLINE: how long they hold", "to the end of the program", "fixed"),
    ("Function variables: whether they are modal", "yes", "`modal`"),
    ("`&G91&`: what is initialised", "the whole group of the code", "fixed"),
    ("`&F&`: the value", "stays; only X, Y and Z go to the machining origin", "fixed"),
    ("Omission: what is compared", "the text that was written last", "fixed"),
    ("`!-G01!` when it is written", "its mode is in force from then on", "fixed"),
    (
        "A code without a group",
        "has no mode: `!-G28!` is always written, `&G28&` does nothing",
        "`group`",
    ),
    ("Sequence number: its place with OUTPUTORDER 1", "-100", "`[nc_code]` SEQUENCE_NUMBER"),
    ("Sequence number: its place otherwise", "the first of the block, after STARTOFLINE", "fixed"),
    ("Sequence number: options besides 2", "0: no block, 1: every block", "`sequence_place`"),
    ("`@0@` and `@1@` in one block", "no number", "fixed"),
    ("Lines without output, also of nothing but blanks", "no block, no number", "fixed"),
    (
        "Blanks without quotes (Manual 001, lines 20 and 22)",
        "written as they stand, also at the end of a line, after "
        "texts, codes and numbers alike; alone they make no block",
        "fixed",
    ),
    (
        "`separator`: which elements",
        "codes and function variables, but those with `separator = false`; no texts",
        "`[nc_code]`",
    ),
    ("DMS, ADMS: the packed form", "D.MMSS, with decimals of seconds after", "fixed"),
    ("TAN, ASIN, ACOS, ATAN", "in radians", "fixed"),
    ("`&&` and `||`", "`&&` binds closer; what is decided is not looked at further", "fixed"),
    ("IF on texts", "refused: an expression is of words with numbers, constants and operators (8)", "fixed"),
    (
        "Words and events that the manual does not list",
        "marked as additions; with `strict` there are none",
        "`strict`",
    ),
    ("Unknown search keys, words and macros", "refused when the file is read", "fixed"),
    ("`$V1$` for a variable without a format", "refused when the file is read", "fixed"),
    ("Division by zero and the like", "an error; no program is written", "fixed"),
    ("`%d` for a number with decimals", "rounded", "fixed"),
]
