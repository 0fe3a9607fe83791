/* tev.c - tev's protocol: packets of a length (4 bytes, with itself), a type (1 byte) and what belongs to it; numbers begin with
 * their lowest byte, texts end with a 0. It answers nothing.
 * SPDX-License-Identifier: Apache-2.0 */
#include "preview/tev.h"

#include <errno.h>
#include <netdb.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "base/buf.h"

enum { PACKET_CLOSE_IMAGE = 2, PACKET_CREATE_IMAGE = 4, PACKET_UPDATE_IMAGE = 6 };
/* A large picture goes in several packets, which tev keeps whole in memory. */
enum { MOST_FLOATS_OF_A_PACKET = 1 << 22 };
/* for which a render waits */
static const struct timeval patience = {.tv_sec = 5};

struct Tev {
    int socket;
    char *host, *port, *name;
    uint32_t width, height, n_channels; /* of the picture that was created; 0: none */
};

/* ---- connecting ---- */

static Status cannot_reach(const char *host, const char *port, const char *reason, Error *error)
{
    return fail(error, STATUS_OUTPUT, "no tev takes pictures at %s:%s (%s); start tev first", host, port, reason);
}

/* < 0, and errno, where it cannot be had. */
static int connect_to(const struct addrinfo *address)
{
    int descriptor = socket(address->ai_family, address->ai_socktype, address->ai_protocol);
    if (descriptor < 0) return -1;
    /* on Linux it bounds the time of connect(), too */
    if (setsockopt(descriptor, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience) == 0 &&
        connect(descriptor, address->ai_addr, address->ai_addrlen) == 0)
        return descriptor;
    int reason = errno;
    close(descriptor);
    errno = reason == EINPROGRESS ? ETIMEDOUT : reason;
    return -1;
}

static Status connect_any(Tev *tev, Error *error)
{
    struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM}, *addresses = NULL;
    int failed = getaddrinfo(tev->host, tev->port, &hints, &addresses);
    if (failed) return cannot_reach(tev->host, tev->port, gai_strerror(failed), error);
    int reason = 0;
    for (const struct addrinfo *a = addresses; a && tev->socket < 0; a = a->ai_next) {
        tev->socket = connect_to(a);
        if (tev->socket < 0) reason = errno;
    }
    freeaddrinfo(addresses);
    return tev->socket >= 0 ? STATUS_OK : cannot_reach(tev->host, tev->port, strerror(reason), error);
}

Status tev_open(const char *host, const char *port, const char *name, Tev **tev, Error *error)
{
    Tev *made = calloc(1, sizeof *made);
    if (!made) return fail_memory(error, sizeof *made, "a connection to tev");
    *made = (Tev){.socket = -1, .host = strdup(host), .port = strdup(port), .name = strdup(name)};
    Status status = made->host && made->port && made->name
                        ? connect_any(made, error)
                        : fail_memory(error, strlen(host) + strlen(port) + strlen(name), "a connection to tev");
    *tev = status == STATUS_OK ? made : NULL;
    if (status != STATUS_OK) tev_close(made);
    return status;
}

void tev_close(Tev *tev)
{
    if (!tev) return;
    if (tev->socket >= 0) close(tev->socket);
    free(tev->host);
    free(tev->port);
    free(tev->name);
    free(tev);
}

/* ---- packets ---- */

static void add_number(Buf *packet, uint64_t value, unsigned n_bytes)
{
    char bytes[8];
    for (unsigned i = 0; i < n_bytes; i++) bytes[i] = (char)(unsigned char)(value >> (8 * i) & 255);
    buf_add_bytes(packet, bytes, n_bytes);
}

static void add_text(Buf *packet, const char *text)
{
    buf_add_bytes(packet, text, strlen(text) + 1);
}

static void add_float(Buf *packet, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    add_number(packet, bits, 4);
}

/* The length comes in when the packet is sent. grab: whether tev shows this picture instead of the one that it shows. */
static Buf begin_packet(int type, bool grab, const char *name)
{
    Buf packet = {0};
    add_number(&packet, 0, 4);
    add_number(&packet, (uint64_t)type, 1);
    if (type != PACKET_CLOSE_IMAGE) add_number(&packet, grab, 1);
    add_text(&packet, name);
    return packet;
}

static Status send_all(const Tev *tev, const char *bytes, size_t length, Error *error)
{
    while (length) {
        ssize_t sent = send(tev->socket, bytes, length, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent < 0)
            return fail(error, STATUS_OUTPUT, "tev at %s:%s takes no more pictures (%s)", tev->host, tev->port,
                        errno == EAGAIN || errno == EWOULDBLOCK ? "it does not answer" : strerror(errno));
        bytes += sent;
        length -= (size_t)sent;
    }
    return STATUS_OK;
}

/* Frees the packet. */
static Status send_packet(const Tev *tev, Buf *packet, Error *error)
{
    Status status;
    if (packet->failed) {
        status = fail_memory(error, packet->length, "a picture for tev");
    } else {
        for (unsigned i = 0; i < 4; i++) packet->text[i] = (char)(unsigned char)(packet->length >> (8 * i) & 255);
        status = send_all(tev, packet->text, packet->length, error);
    }
    buf_clear(packet);
    return status;
}

/* ---- pictures ---- */

static Status create(Tev *tev, const Image *image, Error *error)
{
    bool first = tev->width == 0;
    if (!first) {
        Buf old = begin_packet(PACKET_CLOSE_IMAGE, false, tev->name);
        TRY(send_packet(tev, &old, error));
    }
    Buf packet = begin_packet(PACKET_CREATE_IMAGE, true, tev->name);
    add_number(&packet, image->width, 4);
    add_number(&packet, image->height, 4);
    add_number(&packet, image->n_channels, 4);
    for (uint32_t c = 0; c < image->n_channels; c++) add_text(&packet, image->names[c]);
    TRY(send_packet(tev, &packet, error));
    tev->width = image->width;
    tev->height = image->height;
    tev->n_channels = image->n_channels;
    return STATUS_OK;
}

/* Rows y0 to y1, without the last: channels are interleaved, each so many floats behind the first, a pixel every so many. */
static Status update_rows(const Tev *tev, const Image *image, uint32_t y0, uint32_t y1, Error *error)
{
    Buf packet = begin_packet(PACKET_UPDATE_IMAGE, false, tev->name);
    add_number(&packet, image->n_channels, 4);
    for (uint32_t c = 0; c < image->n_channels; c++) add_text(&packet, image->names[c]);
    const uint32_t place[4] = {0, y0, image->width, y1 - y0};
    for (unsigned i = 0; i < 4; i++) add_number(&packet, place[i], 4);
    for (uint32_t c = 0; c < image->n_channels; c++) add_number(&packet, c, 8);
    for (uint32_t c = 0; c < image->n_channels; c++) add_number(&packet, image->n_channels, 8);
    size_t n = (size_t)image->width * image->n_channels;
    for (size_t i = y0 * n; i < y1 * n; i++) add_float(&packet, image->pixels[i]);
    return send_packet(tev, &packet, error);
}

Status tev_show(Tev *tev, const Image *image, Error *error)
{
    if (tev->width != image->width || tev->height != image->height || tev->n_channels != image->n_channels)
        TRY(create(tev, image, error));
    size_t floats_of_row = (size_t)image->width * image->n_channels;
    uint32_t rows = (uint32_t)(MOST_FLOATS_OF_A_PACKET / floats_of_row);
    if (rows == 0) rows = 1;
    for (uint32_t y = 0; y < image->height; y += rows)
        TRY(update_rows(tev, image, y, image->height - y < rows ? image->height : y + rows, error));
    return STATUS_OK;
}
