/* parse_habits.h - what is written in the way of other languages, or with a bracket left out. Functions that return a
 * truth say whether they read something, after a report.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PARSE_HABITS_H
#define MEN_PARSE_HABITS_H

#include "lang/parser.h"

/* -- statements (parse_habits.c) -- */
bool parse_value_habit(Parser *parser); /* a value where a statement should begin */
bool parse_comma_habit(Parser *parser);
bool parse_name_habit(Parser *parser, Path path);           /* behind a path that nothing of the grammar follows */
bool parse_lone_word(Parser *parser, Path path);            /* "break", behind it */
void parse_two_names(Parser *parser, Path path);            /* behind the first, at the second; no '{' follows */
bool parse_function_habit(Parser *parser, Path path);       /* "f(x) = ...", at the '=' */
void parse_member_change(Parser *parser, Path path);        /* "a.x := 5", behind the path */
void parse_unquoted_file(Parser *parser, const char *word); /* behind 'use' or 'include', where a string should stand */
/* let a, b = 1, 2 at the comma, behind the first name */
void parse_names_together(Parser *parser, const Symbol *first);
bool parse_declared_change(Parser *parser, const Symbol *name, const char *word); /* let n += 1, behind the name */
/* Behind a name that is declared, without a value: "var n" */
bool parse_no_value(Parser *parser, const char *expected, const char *hint);
/* def f(x): number = ... and def f(x) -> number = ..., behind the parameters, at what tells the type */
void parse_result_type(Parser *parser, const char *head);

/* -- blocks (parse_habits_block.c) -- */
bool parse_block_habit(Parser *parser, Path path); /* a block that is POV-Ray's, at its '{' */
bool parse_brace_habit(Parser *parser);            /* a block without anything in front of it, or a '{' too many */
/* Behind the head of a def of that text, without '=' or '{'; reports: that has not been said. NULL: it was a block. */
Expr *parse_bodiless_def(Parser *parser, const char *head, bool reports);
/* Behind 'if (...)' and the like, where the '{' is missing: the block up to its '}' or 'end', or one statement. */
void parse_bare_block(Parser *parser, Block *block);
bool lacks_opening_brace(Parser *parser); /* whether there is a '}' too many up to the end of the text */
/* What stands in a block whose '{' is missing, and its '}'; node: whose it is, or NULL. */
void block_without_opening(Parser *parser, const char *node);

/* -- loops and choices (parse_habits_flow.c) -- */
bool parse_foreach(Parser *parser);       /* at a word: "foreach" is taken for a 'for', which is then the next token */
bool parse_do_loop(Parser *parser);       /* at a word */
bool parse_switch(Parser *parser);        /* at a word */
bool parse_counting_loop(Parser *parser); /* behind the '(' of 'for' */
void parse_loop_type(Parser *parser);     /* at what stands there otherwise: "int i" */
void parse_loop_step(Parser *parser);     /* behind a range: "step 2" */
/* for (x in a, y in b), at the comma: read to its end and reported; else nothing. */
void parse_second_variable(Parser *parser, const char *first);
/* "1 to 9" and "1:9" in a loop, behind the first, which is from begin on; with steps, "1..9 step 2", too, behind the 9. They
 * are read to the end, and returned as they are written here; NULL: it is none of them. */
const char *parse_range_habit(Parser *parser, uint32_t begin, bool with_steps, bool reports);
void parse_three_points(Parser *parser, const Expr *first); /* at the '..' behind that: "1...5" */

/* -- expressions (parse_habits_expr.c) -- */
bool parse_color_habit(Parser *parser, const char *word);            /* behind the word */
bool parse_array_habit(Parser *parser, const char *word, Span span); /* behind the word */
bool parse_vector_comparison(Parser *parser);            /* at a '>' behind an element of a vector, which may end it */
bool parse_operator_habit(Parser *parser, Span operand); /* at what stands behind it */
Expr *parse_braced_body(Parser *parser, const Def *def); /* a value in a def's braces; NULL: there are statements */
Expr *parse_names_and_value(Parser *parser, const char *head); /* lets and a value in braces, of a def of that head */
void parse_if_value(Parser *parser); /* "if (a) b else c" where a value should stand, at the 'if' */
void parse_else_of_element(Parser *parser, const Expr *element); /* the same in a list, at the 'else' */
Expr *parse_bare_let(Parser *parser, Span begin);   /* a let without brackets, behind the word; NULL: it is none */
void parse_apart_unit(Parser *parser, Span number); /* at a name behind the number */
void parse_vector_unit(Parser *parser);             /* at a name behind a vector */
bool parse_percent_habit(Parser *parser, const Expr *number); /* at what stands behind a factor */
/* "x -> x * 2" and "def(x) = x * 2" where the value of a declaration or of a property should stand: read to its end, and poison;
 * NULL: it is none */
Expr *parse_arrow_function(Parser *parser, const char *name, bool declared);
Expr *parse_whole_value(Parser *parser); /* of a statement, with "1 if a else 2", and "7 // 2", which is warned of */

/* -- directives (parse_directives.c) -- */
void parse_directive(Parser *parser);

/* -- what these files share -- */
/* The text from begin to end on one line, for a hint; "..." where it is too long for that. */
const char *quote(const Parser *parser, uint32_t begin, uint32_t end);
const char *quote_read(Parser *parser, Expr *(*parse)(Parser *)); /* reads a nonterminal; its text, as quote has it */
Diagnostic *report_at(Parser *parser, Span span, const char *format, ...) ATTR_PRINTF(3, 4);
Span behind_last(const Parser *parser); /* the empty place behind the last consumed token */
void hint_write(Parser *parser, Diagnostic *report, const char *text);
bool is_color_word(const char *word); /* "rgb" and its like */

#endif
