/* habits.h - what writers of other languages write by habit, for the hints of messages: the rows of habits.def.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_HABITS_H
#define MEN_HABITS_H

#include <stdbool.h>

#include "base/arena.h"
#include "lang/schema.h"

/* How a directive of POV-Ray goes on, so that the parser can, too. */
typedef enum DirectiveForm {
    DIRECTIVE_NONE,
    DIRECTIVE_BIND,   /* name = expression */
    DIRECTIVE_LOOP,   /* (name, first, last [, step]), up to its #end */
    DIRECTIVE_OPENS,  /* something in brackets, up to its #end */
    DIRECTIVE_MIDDLE, /* between an opening one and its #end */
    DIRECTIVE_END,
    DIRECTIVE_LINE /* nothing that matters behind it */
} DirectiveForm;

/* Words, which have blanks between them, and what is said of them. */
typedef struct HabitRow {
    const char *words, *text;
} HabitRow;

/* Is the word one of those, which have blanks between them? */
bool habit_is_one_of(const char *words, const char *word);
/* Word is length bytes, without its '#'; DIRECTIVE_NONE when POV-Ray has none of that name. */
DirectiveForm habit_directive(const char *word, size_t length);
/* The rest answer NULL for words that they do not know. */
const char *habit_directive_pattern(const char *word);
const char *habit_values(const char *node);
/* What takes the place of a file that comes with POV-Ray, without its ending; NULL: of another one. */
const char *habit_library(const char *name);
const char *habit_block(const char *word);                     /* POV-Ray's */
const HabitRow *habit_blocks(size_t *n);                       /* all of them */
const char *habit_node(const char *word);                      /* the same and those of others */
const char *habit_setting(const char *node, const char *word); /* node: NULL at the top */
const char *habit_word(const char *word);
const char *habit_export(const char *file, const char *word); /* "std/media.mns": the names of it that may be meant */
const char *habit_statement(const char *word);
const char *habit_choice(const char *property, const char *word);
const char *habit_instead(const char *property, const char *word); /* of a choice that there is none for: a hint */
const char *habit_unit(const char *word);
const char *habit_property(const char *node, const char *word, unsigned number); /* the candidates, from number 0 */
const char *habit_property_of(const char *node, const char *word);               /* of nodes of that very type */
/* What is written for a candidate, with that value where the candidate does not bring its own. */
const char *habit_assignment(Arena *arena, const char *candidate, const char *value);
/* Of a word in a node of that type: a hint. */
const char *habit_advice(const char *node, const char *word);
/* Of a word that is no parameter of a def with these formals: a hint. */
const char *habit_formal(const char *const *formals, size_t n, const char *word);
/* Of a property of such a node that takes no texture, where one stands: a hint, with '@' for the texture. */
const char *habit_pattern(const char *node, const char *property);
/* What to do with a text that begins so. */
const char *habit_file(const char *text);
/* Of a value that measures something else than the property does: a hint. */
const char *habit_measure(const char *node, const char *property, PropUnit unit);
/* Of a plain number that such a property of such a node would hardly have: what the property is, and a hint, with '@' for the
 * number; NULL: it may well have it. */
const char *habit_unlikely(const char *node, const char *property, double number, const char **what);
bool habit_is_type(const char *word);
bool habit_is_function(const char *word);
bool habit_is_import(const char *word);
bool habit_holds_nodes(const char *node);
/* The pattern with text for its '@', or "@*". */
const char *habit_fill(Arena *arena, const char *pattern, const char *text);

#endif
