/* terminal_preview.c - by moves relative to the line of the cursor, which is where progress is shown, too.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/terminal_preview.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include "cli/signals.h"
#include "cli/talk.h"

#define CLEAR_LINE "\r\033[K"
#define CURSOR_UP "\033[%uA"
#define CURSOR_DOWN "\033[%uB"
#define SAVE_CURSOR "\0337"
#define RESTORE_CURSOR "\0338"

enum { USUAL_ROWS = 24, FEWEST_ROWS = 3 };

extern char **environ;

Status terminal_preview_check(Error *error)
{
    if (terminal_is_capable()) return STATUS_OK;
    return fail(error, STATUS_USAGE,
                "'--preview term' shows pictures in the terminal on standard error, and there is none that can; "
                "'--preview now.png' is for viewers that watch a file");
}

/* All but the line of progress and one for the shell's next words. */
static TerminalSize free_size(void)
{
    struct winsize window;
    TerminalSize size = {.columns = terminal_columns(), .rows = USUAL_ROWS};
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_row > 0) {
        size.rows = window.ws_row;
        if (window.ws_col > 0) size.cell_width = window.ws_xpixel / window.ws_col;
        size.cell_height = window.ws_ypixel / window.ws_row;
    }
    size.rows = size.rows > FEWEST_ROWS ? size.rows - 2 : 1;
    return size;
}

Status terminal_preview_show(TerminalPreview *preview, const Image *shown, Error *error)
{
    TerminalSize size = free_size();
    TerminalPicture picture = {.rows = 0};
    Buf text = {0};
    Status status = terminal_picture_draw(shown, &size, preview->graphics, environ, &picture, error);
    if (status != STATUS_OK) {
        buf_clear(&picture.text);
        return status;
    }
    const bool is_graphics = picture.is_graphics;
    const unsigned rows = picture.rows;
    bool in_place = preview->rows == rows && preview->lines == talk_lines() && !*signals_flag();
    buf_add(&text, CLEAR_LINE);
    if (!in_place && is_graphics) buf_add_repeat(&text, '\n', rows); /* room, where it is the terminal's last line */
    if (in_place || is_graphics) buf_format(&text, CURSOR_UP, rows);
    if (is_graphics) buf_add(&text, SAVE_CURSOR);
    buf_add_bytes(&text, buf_text(&picture.text), picture.text.length);
    if (is_graphics)
        buf_format(&text, RESTORE_CURSOR CURSOR_DOWN "\r", rows);
    else
        buf_add(&text, "\n");
    talk_write(&text);
    preview->rows = rows;
    preview->lines = talk_lines();
    buf_clear(&picture.text);
    buf_clear(&text);
    return STATUS_OK;
}
