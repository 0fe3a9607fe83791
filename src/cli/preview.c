/* preview.c - reads the words of --preview, and shows pictures there.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/preview.h"

#include <stdlib.h>
#include <string.h>

/* "term", "term:sixel": what stands behind the colon, "" without one; NULL: it is another word */
static const char *behind_word(const char *where, const char *word)
{
    size_t length = strlen(word);
    if (strncmp(where, word, length) != 0) return NULL;
    if (where[length] == ':') return where + length + 1;
    return where[length] ? NULL : where + length;
}

static Status open_terminal(const char *graphics, Preview *preview, Error *error)
{
    if (*graphics && !terminal_graphics_from_text(graphics, &preview->terminal.graphics))
        return fail(
            error, STATUS_USAGE,
            "option '--preview': there are no graphics '%s' of terminals; symbols, sixel, kitty and iterm2 are known",
            graphics);
    preview->kind = PREVIEW_TERMINAL;
    return terminal_preview_check(error);
}

/* HOST:PORT, HOST or nothing; an address of IPv6 stands in brackets before a port. */
static Status open_tev(const char *place, const char *name, Preview *preview, Error *error)
{
    const char *host = place, *port = TEV_PORT, *bracket = strchr(place, ']'), *colon = strrchr(place, ':');
    size_t length = strlen(place);
    if (place[0] == '[' && bracket) {
        host = place + 1;
        length = (size_t)(bracket - host);
        if (bracket[1] == ':') port = bracket + 2;
    } else if (colon && colon == strchr(place, ':')) {
        length = (size_t)(colon - place);
        port = colon + 1;
    }
    char *host_text = length ? strndup(host, length) : strdup(TEV_HOST);
    if (!host_text) return fail_memory(error, length + 1, "the name of a host");
    Status status = tev_open(host_text, *port ? port : TEV_PORT, name, &preview->tev, error);
    free(host_text);
    if (status == STATUS_OK) preview->kind = PREVIEW_TEV;
    return status;
}

static Status open_file(const char *path, Preview *preview, Error *error)
{
    if (strcmp(path, "-") == 0)
        return fail(error, STATUS_USAGE, "a preview is written again and again: it needs a file, not standard output");
    TRY(output_choose_format(path, &preview->file.png, error));
    TRY(output_probe(path, error));
    preview->kind = PREVIEW_FILE;
    preview->file.path = strdup(path);
    return preview->file.path ? STATUS_OK : fail_memory(error, strlen(path) + 1, "the name of the preview");
}

Status preview_open(const char *where, const char *name, Preview *preview, Error *error)
{
    *preview = (Preview){.kind = PREVIEW_NONE};
    if (!where) return STATUS_OK;
    const char *graphics = behind_word(where, "term"), *place = behind_word(where, "tev");
    if (graphics) return open_terminal(graphics, preview, error);
    return place ? open_tev(place, name, preview, error) : open_file(where, preview, error);
}

void preview_close(Preview *preview)
{
    free(preview->file.path);
    tev_close(preview->tev);
    *preview = (Preview){.kind = PREVIEW_NONE};
}

bool preview_is_for_display(const Preview *preview)
{
    return preview->kind == PREVIEW_TERMINAL || preview->file.png;
}

static Status show_in_terminal(TerminalPreview *terminal, const Image *image, const ColorConfig *color,
                               const ColorLook *look, Error *error)
{
    Image shown;
    ColorLook opaque = *look;
    opaque.alpha = false;
    TRY(image_for_display(image, color, &opaque, &shown, error));
    Status status = terminal_preview_show(terminal, &shown, error);
    image_clear(&shown);
    return status;
}

Status preview_show(Preview *preview, const Image *image, Pool *pool, const ColorConfig *color, const ColorLook *look,
                    Error *error)
{
    ExrOptions exr = {.half = true, .pool = pool};
    switch (preview->kind) {
    case PREVIEW_NONE: break;
    case PREVIEW_FILE: return output_write(&preview->file, image, &exr, color, look, error);
    case PREVIEW_TERMINAL: return show_in_terminal(&preview->terminal, image, color, look, error);
    case PREVIEW_TEV: return tev_show(preview->tev, image, error);
    }
    return STATUS_OK;
}
