#!/usr/bin/env python3
"""Random sentences of grammar/meniscus.ebnf, and mutations of them, against the parser of meniscus.

usage: sentences.py MENISCUS EBNF [SENTENCES [SEED]]

The grammar file is read, not copied: sentences are derived from it, and whether a mutated row of tokens is still a sentence
is decided by an Earley recognizer that is made from it. The parser must agree each time. It is asked through
'meniscus fmt', which parses and does not evaluate; that it changes no token, and that laying out twice is as good as
once, is seen on the way.
SPDX-License-Identifier: Apache-2.0
"""
import os
import random
import re
import subprocess
import sys
import tempfile

# ---- the notation of the grammar ----

TOKEN = re.compile(r'\s+|"[^"]*"|\'[^\']*\'|\.\.\.|[A-Za-z_][A-Za-z0-9_]*|[=|;{}()\[\]]', re.S)


def comment_end(text, at):
    depth = 0
    while True:
        if text.startswith("(*", at):
            depth, at = depth + 1, at + 2
        elif text.startswith("*)", at):
            depth, at = depth - 1, at + 2
        else:
            at += 1
        if depth == 0:
            return at


def read_rules(text):
    """name -> tree; trees are ('lit', text), ('ref', name), ('seq', [..]), ('alt', [..]), ('opt', t), ('rep', t),
    ('range', first, last)."""
    words, at = [], 0
    while at < len(text):
        if text.startswith("(*", at):
            at = comment_end(text, at)
            continue
        match = TOKEN.match(text, at)
        if not match:
            raise SystemExit(f"grammar: what is this? {text[at:at + 40]!r}")
        if not match.group().isspace():
            words.append(match.group())
        at = match.end()
    rules, i = {}, 0

    def alternatives():
        options = [sequence()]
        while words[i] == "|":
            step()
            options.append(sequence())
        return options[0] if len(options) == 1 else ("alt", options)

    def step():
        nonlocal i
        i += 1

    def sequence():
        items = []
        while words[i] not in ("|", ";", ")", "]", "}"):
            items.append(item())
        return items[0] if len(items) == 1 else ("seq", items)

    def item():
        word = words[i]
        step()
        if word in ("(", "[", "{"):
            inner = alternatives()
            step()
            return inner if word == "(" else ("opt" if word == "[" else "rep", inner)
        if word[0] in "\"'":
            literal = ("lit", word[1:-1])
            if words[i] == "...":
                step()
                last = words[i]
                step()
                return ("range", word[1:-1], last[1:-1])
            return literal
        return ("ref", word)

    while i < len(words):
        name = words[i]
        i += 2  # the name and '='
        rules[name] = alternatives()
        step()  # ';'
    return rules


LEXICAL = {"name", "number", "string", "hexcol", "unit"}

# ---- random derivations ----

LEAST = {}


def least_depth(rules, tree, seen=()):
    kind = tree[0]
    if kind in ("lit", "range", "opt", "rep"):
        return 0
    if kind == "ref":
        name = tree[1]
        if name in LEXICAL or name not in rules:
            return 0
        if name in seen:
            return 10 ** 6
        if name not in LEAST or seen:
            depth = 1 + least_depth(rules, rules[name], seen + (name,))
            if seen:
                return depth
            LEAST[name] = depth
        return LEAST[name]
    depths = [least_depth(rules, t, seen) for t in tree[1]]
    return max(depths, default=0) if kind == "seq" else min(depths)


class Sentence:
    def __init__(self, rules, rng, budget):
        self.rules, self.rng, self.budget = rules, rng, budget
        self.tokens = []

    def derive(self, tree, depth):
        kind = tree[0]
        tight = depth <= 0 or len(self.tokens) > self.budget
        if kind == "lit":
            self.tokens.append((tree[1], "lit"))
        elif kind == "ref" and tree[1] in LEXICAL:
            self.tokens.append((lexical(self.rules, self.rng, tree[1], self.tokens), tree[1]))
        elif kind == "ref":
            self.derive(self.rules[tree[1]], depth - 1)
        elif kind == "seq":
            for part in tree[1]:
                self.derive(part, depth)
        elif kind == "opt":
            if not tight and self.rng.random() < 0.4:
                self.derive(tree[1], depth)
        elif kind == "rep":
            while not tight and self.rng.random() < (0.75 if depth > 13 else 0.25) and len(self.tokens) <= self.budget:
                self.derive(tree[1], depth)
        else:
            options = tree[1]
            if tight:
                least = min(least_depth(self.rules, t) for t in options)
                options = [t for t in options if least_depth(self.rules, t) == least]
            self.derive(self.rng.choice(options), depth)


def spell(rules, rng, tree, depth=0):
    """The letters of a lexical rule. Only 'char' and 'other' are described in words in the grammar."""
    kind = tree[0]
    if kind == "lit":
        return tree[1]
    if kind == "range":
        return chr(rng.randint(ord(tree[1]), ord(tree[2])))
    if kind == "ref":
        if tree[1] == "char":
            return rng.choice("abc XYZ019{}<>/*.,;'#\u00e9\u4e2d\U0001f378")
        if tree[1] == "other":
            return rng.choice("\u00e9\u00df\u03b1\u4e2d")
        return spell(rules, rng, rules[tree[1]], depth + 1)
    if kind == "seq":
        return "".join(spell(rules, rng, t, depth) for t in tree[1])
    if kind == "alt":
        return spell(rules, rng, rng.choice(tree[1]), depth)
    if kind == "opt":
        return spell(rules, rng, tree[1], depth) if rng.random() < 0.5 else ""
    text = ""
    while rng.random() < 0.5 and len(text) < 6:
        text += spell(rules, rng, tree[1], depth)
    return text


def keywords(rules):
    return {t[1] for t in rules["keyword"][1]}


def lexical(rules, rng, kind, before):
    if before and before[-1][0] == "meniscus" and len(before) == 1:
        return "1.0"
    if kind == "unit":  # of the header
        return rng.choice(["nm", "um", "mm", "cm", "m", "km", "in", "ft"])
    while True:
        text = spell(rules, rng, rules[kind])
        if kind == "name" and text in keywords(rules):
            continue
        if kind == "number" and re.search(r"[eE][-+]?\d{3}", text):
            continue  # may be too large for a number
        if kind == "string" and any(not 0 < int(u, 16) < 0xd800 for u in re.findall(r"\\u\{([0-9a-fA-F]+)", text)):
            continue  # no code point
        return text


# ---- the recognizer ----

def references(tree):
    if tree[0] == "ref":
        return {tree[1]}
    parts = tree[1] if tree[0] in ("seq", "alt") else [tree[1]] if tree[0] in ("opt", "rep") else []
    return set().union(*map(references, parts))


class Recognizer:
    """Earley's algorithm over classes of tokens."""

    def __init__(self, rules):
        self.productions, self.fresh = {}, 0
        self.rules = rules
        names = ["file"]
        for name in names:
            self.productions[name] = self.flat(rules[name])
            names += [n for n in references(rules[name]) if n not in LEXICAL and n not in names]
        self.nullable = set()
        while True:
            more = {n for n, ps in self.productions.items() if any(all(s in self.nullable for s in p) for p in ps)}
            if more == self.nullable:
                break
            self.nullable = more

    def symbol(self, productions):
        self.fresh += 1
        name = f"${self.fresh}"
        self.productions[name] = productions
        return name

    def flat(self, tree):
        """The tree as a list of productions, each a tuple of symbols; a literal is the symbol '=text'."""
        kind = tree[0]
        if kind == "alt":
            return [p for t in tree[1] for p in self.flat(t)]
        if kind == "seq":
            return [tuple(self.one(t) for t in tree[1])]
        return [(self.one(tree),)]

    def one(self, tree):
        kind = tree[0]
        if kind == "lit":
            return "=" + tree[1]
        if kind == "ref":
            return tree[1]
        if kind == "opt":
            return self.symbol(self.flat(tree[1]) + [()])
        if kind == "rep":
            name = self.symbol([])
            self.productions[name] = [()] + [p + (name,) for p in self.flat(tree[1])]
            return name
        return self.symbol(self.flat(tree))

    def accepts(self, tokens):
        """tokens: a set of terminal symbols for each."""
        columns = [dict() for _ in range(len(tokens) + 1)]
        waiting = [dict() for _ in columns]  # symbol -> items that stand before it

        def add(at, item, queue):
            if item not in columns[at]:
                columns[at][item] = True
                queue.append(item)

        queue = []
        for p in self.productions["file"]:
            add(0, ("file", p, 0, 0), queue)
        for at in range(len(tokens) + 1):
            following = []
            while queue:
                name, body, dot, origin = item = queue.pop()
                if dot == len(body):
                    for parent in list(waiting[origin].get(name, ())):
                        add(at, (parent[0], parent[1], parent[2] + 1, parent[3]), queue)
                    continue
                symbol = body[dot]
                if symbol in self.productions:
                    waiting[at].setdefault(symbol, []).append(item)
                    for p in self.productions[symbol]:
                        add(at, (symbol, p, 0, at), queue)
                    if symbol in self.nullable:
                        add(at, (name, body, dot + 1, origin), queue)
                elif at < len(tokens) and symbol in tokens[at]:
                    following.append((name, body, dot + 1, origin))
            if at == len(tokens):
                return any(i[0] == "file" and i[2] == len(i[1]) and i[3] == 0 for i in columns[at])
            for item in following:
                add(at + 1, item, queue)
            if not queue:
                return False


UNITS = {"nm", "um", "mm", "cm", "m", "km", "in", "ft"}


def classes(rules, text, kind):
    """What a token can be in the grammar. Words such as unit are names, too."""
    if kind != "lit":
        found = {kind}
    elif re.match(r"[A-Za-z_]", text) and text not in keywords(rules):
        found = {"name"}
    else:
        found = set()
    if kind in ("name", "unit", "lit"):
        found.add("=" + text)
        if text in UNITS:
            found.add("unit")
        if kind == "unit" and text not in keywords(rules):
            found.add("name")
    return found


def unit_node(tokens):
    """Behind the version the word unit and a name belong to the header, says the grammar in words."""
    words = [t[0] for t in tokens[2:4]] + ["", ""]
    return words[0] == "unit" and words[1] not in UNITS and re.match(r"\w", words[1]) is not None


def mutate(tokens, rng, others):
    tokens = list(tokens)
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        at = rng.randrange(3, len(tokens)) if len(tokens) > 3 else len(tokens) - 1
        change = rng.randrange(4)
        if change == 0:
            del tokens[at]
        elif change == 1:
            tokens.insert(at, rng.choice(others))
        elif change == 2:
            tokens[at] = rng.choice(others)
        else:
            other = rng.randrange(min(3, len(tokens) - 1), len(tokens))
            tokens[at], tokens[other] = tokens[other], tokens[at]
        if len(tokens) < 3:
            break
    return tokens


# ---- asking meniscus ----

def lay_out(tokens, rng):
    """Blanks, line ends and comments between tokens; brackets and commas sometimes stand close."""
    text = ""
    for word, kind in tokens:
        close = text and (text[-1] in "()[]{},;" or word in ("(", ")", "[", "]", "{", "}", ",", ";"))
        if text and not (close and rng.random() < 0.5):
            text += rng.choice((" ", " ", "  ", "\n", "\t", " /* a /* b */ */ ", " // c\n", "\r\n"))
        text += word
    return text + "\n"


def fmt(program, option, folder, names):
    return subprocess.run([os.path.abspath(program), "fmt", option, "--color", "never", *names], cwd=folder,
                          capture_output=True, text=True, encoding="utf-8", errors="replace")


def refused(program, texts):
    """The numbers of the texts that the parser refuses."""
    with tempfile.TemporaryDirectory() as folder:
        names = []
        for i, text in enumerate(texts):
            names.append(f"{i}.mns")
            with open(os.path.join(folder, names[-1]), "w", encoding="utf-8", newline="") as file:
                file.write(text)
        done = fmt(program, "-i", folder, names)
        if done.returncode not in (0, 1, 3):
            raise SystemExit(f"meniscus fmt ended with status {done.returncode}: {done.stderr[-2000:]}")
        for line in done.stderr.splitlines():
            if "this is a mistake of meniscus" in line:
                raise SystemExit(line + "\n" + texts[int(re.search(r"'(\d+)\.mns'", line).group(1))])
        wrong = {int(n) for n in re.findall(r"^(\d+)\.mns:\d+:\d+: error:", done.stderr, re.M)}
        again = fmt(program, "--check", folder, [n for i, n in enumerate(names) if i not in wrong])
        for name in again.stdout.split():
            raise SystemExit("what fmt laid out changes when it is laid out again:\n" + texts[int(name[:-4])])
        return wrong


def main():
    program, grammar = sys.argv[1:3]
    n_sentences = int(sys.argv[3]) if len(sys.argv) > 3 else 2000
    rng = random.Random(int(sys.argv[4]) if len(sys.argv) > 4 else 1)
    rules = read_rules(open(grammar, encoding="utf-8").read())
    for name in "char", "letter", "other":
        rules.setdefault(name, ("lit", "x"))
    recognizer = Recognizer(rules)
    sentences = []
    for _ in range(n_sentences):
        sentence = Sentence(rules, rng, rng.choice((10, 30, 80)))
        sentence.derive(rules["file"], 18)
        sentences.append(sentence.tokens)
    others = [t for s in sentences for t in s[2:]]
    n_passed = n_failed = 0

    def report(fine, text, why):
        nonlocal n_passed, n_failed
        if fine:
            n_passed += 1
            return
        n_failed += 1
        if n_failed <= 20:
            print(f"not ok - {why}:\n" + "".join(f"#   {line}\n" for line in text.splitlines()), end="")

    texts = [lay_out(s, rng) for s in sentences]
    wrong = refused(program, texts)
    for i, text in enumerate(texts):
        report(i not in wrong, text, "a sentence of the grammar is refused")
    # what the recognizer says of the sentences themselves is a test of the recognizer
    mutants = [mutate(s, rng, others) for s in sentences if 5 < len(s) < 60]
    texts = [lay_out(s, rng) for s in mutants]
    wrong = refused(program, texts)
    n_outside = 0
    for i, tokens in enumerate(mutants):
        inside = recognizer.accepts([classes(rules, *token) for token in tokens]) and not unit_node(tokens)
        n_outside += not inside
        report(inside == (i not in wrong), texts[i],
               "a mutation that is still in the grammar is refused" if inside
               else "a mutation that is not in the grammar is accepted")
    for tokens in sentences[:200]:
        if len(tokens) < 60:
            report(recognizer.accepts([classes(rules, *token) for token in tokens]), lay_out(tokens, rng),
                   "the recognizer refuses a sentence")
    print(f"{len(sentences)} sentences; {len(mutants)} mutations, {n_outside} of them outside of the grammar")
    print(f"{n_passed} passed, {n_failed} failed")
    return n_failed > 0


if __name__ == "__main__":
    sys.exit(main())
