"""Program text to running code: places, tokens, powers of operators, traced Python."""

from __future__ import annotations

import ast
import gc
import itertools
from contextlib import ExitStack

import pytest

from polycnc.errors import ProgramError
from polycnc.language import (
    Chain,
    Emitter,
    Flaw,
    Infix,
    Lexicon,
    Operators,
    Prefix,
    Python,
    Source,
    Token,
    Tokens,
    Tree,
    Unary,
    frame_of,
    infix,
    prefix,
    read_expression,
    real_value,
    whole_value,
    without_collection,
)

LEXICON = Lexicon(
    (
        ("number", r"[0-9]+(?:\.[0-9]+)?"),
        ("text", r'"[^"\n]*"'),
        ("name", r"[A-Za-z]+"),
        ("mark", r"[-+*/()=~]"),
    ),
    folded=("name",),
    unfinished={'"': ("the text has no end", 'write " after it')},
)
OPERATORS = Operators(
    infix={
        "=": Infix(1, single=True), "+": Infix(2), "-": Infix(2), "OR": Infix(2),
        "*": Infix(3), "/": Infix(3), "AND": Infix(3),
    },
    prefix={"NOT": Prefix(4, repeats=True), "-": Prefix(2)},
)  # fmt: skip


def read(text: str) -> Tree[Token]:
    tokens = Tokens(LEXICON, text, nesting=7)

    def operand() -> Tree[Token]:
        if tokens.token.word == "(":
            with tokens.nested(tokens.step().at):
                inner = read_expression(tokens, OPERATORS, operand)
                tokens.expect(")", "close it")
            return inner
        if tokens.token.kind not in ("number", "name", "text"):
            raise Flaw(tokens.token.at, f"a value is missing before {tokens.token}")
        return tokens.step()

    tree = read_expression(tokens, OPERATORS, operand)
    tokens.end("the expression")
    return tree


def shape(tree: Tree[Token]) -> object:
    match tree:
        case Unary():
            return [tree.operator, shape(tree.operand)]
        case Chain():
            return [
                shape(tree.first),
                *(part for link in tree.links for part in (link.operator, shape(link.operand))),
            ]
        case Token():
            return tree.word


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("2+3*5-7", ["2", "+", ["3", "*", "5"], "-", "7"]),
        ("(2+3)*5", [["2", "+", "3"], "*", "5"]),
        ("2-(3-5)", ["2", "-", ["3", "-", "5"]]),
        ("not a and b = c or d", [[["NOT", "A"], "AND", "B"], "=", ["C", "OR", "D"]]),
        ("-a*b+c", [["-", ["A", "*", "B"]], "+", "C"]),
        ("NOT NOT A", ["NOT", ["NOT", "A"]]),
        ('"="="+"', ['"="', "=", '"+"']),
    ],
)
def test_operators_bind_by_their_power_and_from_the_left(text: str, expected: object) -> None:
    assert shape(read(text)) == expected


@pytest.mark.parametrize(
    ("text", "at", "what"),
    [
        ("2+", 2, "a value is missing before the end"),
        ("2 3", 2, "the expression does not go on with '3'"),
        ("(2+3", 4, "')' is missing before the end"),
        ("2 ? 3", 2, "'?' has no meaning here"),
        ('2+"abc', 2, "the text has no end"),
        ("2=3=5", 3, "a second '=' in a row"),
        ("2*-3", 2, "a value is missing before '-'"),
        ("((((((((2))))))))", 7, "more than 7 parentheses inside each other"),
        ("(" * 5000 + "2" + ")" * 5000, 7, "more than 7 parentheses inside each other"),
        ("NOT " * 5000 + "2", 28, "more than 7 operators inside each other"),
        ("2" + "+2" * 500, 1000 - 1, "more than 500 operands in a row"),
    ],
)
def test_what_is_no_expression_is_refused_at_its_place(text: str, at: int, what: str) -> None:
    with pytest.raises(Flaw) as caught:
        read(text)
    assert (caught.value.at, caught.value.what) == (at, what)


def test_five_hundred_operands_are_one_node() -> None:
    tree = read("2" + "*3" * 499)
    assert isinstance(tree, Chain)
    assert len(tree.links) == 499


def test_numbers_of_any_length_have_a_value_or_are_too_large() -> None:
    digits = Token("number", "", "7" * 5000, 3)
    with pytest.raises(Flaw, match=r"the number '7{30}\.\.\.' is too large"):
        real_value(digits)
    with pytest.raises(Flaw) as caught:
        whole_value(digits, 2**31 - 1)
    assert (caught.value.at, caught.value.hint) == (3, "the largest is 2147483647")
    assert whole_value(Token("number", "", "0" * 5000 + "2147483647", 0), 2**31 - 1) == 2147483647
    with pytest.raises(Flaw):
        whole_value(Token("number", "", "2147483648", 0), 2**31 - 1)
    assert real_value(Token("number", "", "0" * 5000 + "2.5", 0)) == 2.5
    with pytest.raises(Flaw):
        real_value(Token("number", "", "38.5", 0), largest=38.0)


def test_an_offset_has_a_line_a_column_and_a_caret() -> None:
    source = Source("AB\r\nCDE\n\nF", "part.cpl")
    assert source.line_count == 4
    assert [source.line(line) for line in (1, 2, 3, 4)] == ["AB", "CDE", "", "F"]
    assert [str(source.position(at)) for at in (1, 3, 6, 8, 9, 10)] == [
        "part.cpl:1:2", "part.cpl:1:3", "part.cpl:2:3", "part.cpl:3:1", "part.cpl:4:1", "part.cpl:4:2",
    ]  # fmt: skip
    error = source.error(Flaw(5, "this is wrong", "do that", code="2167"))
    assert isinstance(error, ProgramError)
    assert str(error) == "part.cpl:2:2: this is wrong [2167]\n    CDE\n     ^\ndo that"
    assert source.error(Flaw(2, "late", line=2)).position == source.position(6)


def value(tree: Tree[Token]) -> Python:
    signs = {"=": "==", "AND": "and", "OR": "or"}
    match tree:
        case Unary():
            return prefix(tree.operator.lower(), value(tree.operand))
        case Chain():
            python = value(tree.first)
            for link in tree.links:
                python = infix(python, signs.get(link.operator, link.operator), value(link.operand))
            return python
        case Token():
            return Python(tree.word)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("2-(3-5)-7", "2 - (3 - 5) - 7"),
        ("(2+3)*5", "(2 + 3) * 5"),
        ("(2=3)=(5=7)", "(2 == 3) == (5 == 7)"),
        ("-a*b", "-(A * B)"),
        ("not(a=b)", "not A == B"),
        ("(not a)=b", "(not A) == B"),
        ("a or b and c", "A or B and C"),
        ("(a or b) and c", "(A or B) and C"),
    ],
)
def test_python_has_the_parentheses_that_it_needs(text: str, expected: str) -> None:
    assert value(read(text)).text == expected


def traced_division() -> Emitter[str]:
    out = Emitter("head")
    with out.block("def run(divisor):"):
        out.place = "first"
        out.put("result = 3.5 / 0.5")
        with out.block("if divisor != 2.0:"):
            out.place = "second"
            out.put("result = 7.0 / divisor")
        with out.block("while result < 0.0:"):
            pass
        out.put("return call(result)")
    return out


def test_an_error_in_running_code_is_led_back_to_its_place() -> None:
    traced = traced_division().compile("<division>")
    known = {"<division>": traced}
    run = traced.load({"call": lambda result: 1 // 0 if result > 3 else result})["run"]
    assert run(7.0) == 1.0
    with pytest.raises(ZeroDivisionError) as caught:
        run(0.0)
    frame = frame_of(caught.value, known.get)
    assert frame is not None
    assert frame == ("<division>", "        result = 7.0 / divisor", "second")
    with pytest.raises(ZeroDivisionError) as below:
        run(2.0)
    frame = frame_of(below.value, known.get)
    assert frame is not None
    assert frame.line.strip() == "return call(result)"
    assert frame_of(ValueError("elsewhere"), known.get) is None


@pytest.mark.parametrize("line", ["open('x')", "__import__('os')", "print(2)", "len('ab')", "import os"])
def test_running_code_has_no_builtins_but_those_that_are_lent(line: str) -> None:
    out = Emitter(5)
    out.put(line)
    with pytest.raises((NameError, ImportError)) as caught:
        out.compile("<restricted>").load({})
    assert caught.type in (NameError, ImportError)


@pytest.mark.parametrize("nested", ["parentheses", "loops"])
def test_code_that_is_too_deep_for_python_is_a_flaw(nested: str) -> None:
    out: Emitter[int] = Emitter(5)
    out.put("b = 2")
    out.place = 37
    if nested == "parentheses":
        out.put(f"a = {'(' * 210}2{')' * 210}")
    else:
        with ExitStack() as blocks:
            for _ in range(21):
                blocks.enter_context(out.block("while 3:"))
    out.place = 41
    out.put("c = 4")
    with pytest.raises(Flaw, match="too long or nested too deeply") as caught:
        out.compile("<deep>")
    assert caught.value.at == 37


def test_code_that_is_only_looked_at_is_not_compiled() -> None:
    out: Emitter[int] = Emitter(5)
    out.put("this is no Python")
    traced = out.compile("<later>")
    with pytest.raises(SyntaxError):
        traced.load({})


BINARY = ("or", "and", "==", "<", "|", "^", "&", "<<", ">>", "+", "-", "*", "/", "//", "%")
COMPARED = {"==", "<"}


def tree_of(text: str) -> str:
    return ast.dump(ast.parse(text))


@pytest.mark.parametrize(("first", "second"), list(itertools.product(BINARY, BINARY)))
def test_pieces_put_together_mean_what_they_meant_and_have_no_more_parentheses(
    first: str, second: str
) -> None:
    a, b, c = Python("a"), Python("b"), Python("c")
    if first == second in ("or", "and"):  # one node either way
        return
    left = infix(infix(a, first, b), second, c).text
    right = infix(a, first, infix(b, second, c)).text
    assert tree_of(left) == tree_of(f"(a {first} b) {second} c")
    assert tree_of(right) == tree_of(f"a {first} (b {second} c)")
    bare = f"a {first} b {second} c"
    if not {first, second} <= COMPARED:
        needs = tree_of(bare) != tree_of(f"(a {first} b) {second} c")
        assert ("(" in left) is needs
        assert ("(" in right) is (tree_of(bare) != tree_of(f"a {first} (b {second} c)")) or first == second


@pytest.mark.parametrize(("sign", "operator"), list(itertools.product(("not", "-", "+", "~"), BINARY)))
def test_signs_stand_before_what_they_belong_to(sign: str, operator: str) -> None:
    a, b = Python("a"), Python("b")
    assert tree_of(prefix(sign, infix(a, operator, b)).text) == tree_of(f"{sign} (a {operator} b)")
    assert tree_of(infix(prefix(sign, a), operator, b).text) == tree_of(f"({sign} a) {operator} b")
    assert tree_of(infix(a, operator, prefix(sign, b)).text) == tree_of(f"a {operator} ({sign} b)")
    twice = prefix(sign, prefix(sign, a)).text
    assert tree_of(twice) == tree_of(f"{sign} ({sign} a)")
    assert "(" not in twice


def test_what_is_left_may_be_entered_again() -> None:
    many = "(2)+(3)*" * 9 + "(5)"
    assert isinstance(read(many), Chain)  # one inside the other they would be too many
    signs = " AND ".join(f"NOT {letter}" for letter in "abcdefghi")
    assert isinstance(read(signs), Chain)
    with pytest.raises(Flaw, match="more than 7 parentheses"):
        read("(2)+(3)+" + "(" * 8 + "5" + ")" * 8)


def test_a_lexicon_reads_one_token_and_says_where_it_ends() -> None:
    text = "  ab*  12.5 "
    assert LEXICON.read(text, 0, len(text)) == (Token("name", "AB", "ab", 2), 4)
    assert LEXICON.read(text, 1, 3) == (Token("name", "A", "a", 2), 3)
    assert LEXICON.read(text, 5, len(text)) == (Token("number", "12.5", "12.5", 7), 11)
    assert LEXICON.read(text, 11, len(text)) == (Token("end", "", "", 12), 12)
    with pytest.raises(Flaw) as caught:
        LEXICON.read("ab  ?", 2, 5)
    assert (caught.value.at, caught.value.what) == (4, "'?' has no meaning here")


def test_tokens_are_stepped_over_taken_and_jumped_to() -> None:
    tokens = Tokens(LEXICON, "xyz ab * (12)  cd ?", 4, 16)
    assert (tokens.token.text, tokens.after, tokens.next_at) == ("ab", 4, 6)
    assert not tokens.take("*")
    assert tokens.token.text == "ab"
    assert tokens.take("AB")
    assert (tokens.after, tokens.token.text) == (6, "*")
    assert tokens.expect("*") == Token("mark", "*", "*", 7)
    tokens.jump(10)
    assert (tokens.after, tokens.token.text, tokens.next_at) == (10, "12", 12)
    with pytest.raises(Flaw) as caught:
        tokens.expect("(", "open it")
    assert (caught.value.at, caught.value.what, caught.value.hint) == (
        10,
        "'(' is missing before '12'",
        "open it",
    )
    tokens.jump(13)
    assert tokens.step() == Token("name", "C", "c", 15)  # the stretch ends within the name
    assert tokens.token == Token("end", "", "", 16)
    tokens.end("it")
    with pytest.raises(Flaw, match="no meaning"):
        Tokens(LEXICON, "ab ?", 3)


def test_a_text_may_begin_with_an_empty_line() -> None:
    source = Source("\nAB\n", "part.cpl")
    assert source.line_count == 3
    assert [source.line(line) for line in (1, 2, 3)] == ["", "AB", ""]
    assert str(source.position(2)) == "part.cpl:2:2"
    assert [source.line_of(at) for at in (0, 1, 3, 4)] == [1, 2, 2, 3]
    assert (source.begin(2), source.end(2)) == (1, 3)


@pytest.mark.parametrize("enabled", [True, False])
def test_the_collector_of_cycles_is_left_as_it_was(enabled: bool) -> None:
    was = gc.isenabled()
    try:
        (gc.enable if enabled else gc.disable)()
        with without_collection():
            assert not gc.isenabled()
        assert gc.isenabled() is enabled
        with pytest.raises(KeyError), without_collection():
            raise KeyError
        assert gc.isenabled() is enabled
    finally:
        (gc.enable if was else gc.disable)()


@pytest.mark.parametrize("error", [RecursionError(), MemoryError()])
def test_a_refusal_without_a_line_is_that_of_the_longest(
    monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise error

    out: Emitter[int] = Emitter(5)
    for place, line in ((11, "a = 2"), (37, f"b = {'2 + ' * 90}2"), (41, "c = 'longer than the first'")):
        out.place = place
        out.put(line)
    monkeypatch.setattr("polycnc.language._python.compile", refuse, raising=False)
    with pytest.raises(Flaw) as caught:
        out.compile("<long>")
    assert caught.value.at == 37
    assert caught.value.hint == "split it"
