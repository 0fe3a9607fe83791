/* tev_test.c - what is sent to tev, read back as its protocol says: by a server that only listens.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

#include "preview/tev.h"

/* ---- a server ---- */

typedef struct Server {
    int listening;
    char port[16];
    pthread_t thread;
    unsigned char *bytes; /* all that came, up to the end of the connection */
    size_t length;
} Server;

static void *listen_to_it(void *context)
{
    Server *server = context;
    int connection = accept(server->listening, NULL, NULL);
    size_t capacity = 1 << 26;
    server->bytes = malloc(capacity);
    for (ssize_t n; server->bytes && server->length < capacity; server->length += (size_t)n)
        if ((n = recv(connection, server->bytes + server->length, capacity - server->length, 0)) <= 0) break;
    close(connection);
    return NULL;
}

/* A socket of this machine, and its port. */
static int bind_free(char port[16])
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof address;
    int bound = socket(AF_INET, SOCK_STREAM, 0);
    assert_int_equal(bind(bound, (struct sockaddr *)&address, size), 0);
    assert_int_equal(getsockname(bound, (struct sockaddr *)&address, &size), 0);
    snprintf(port, 16, "%d", ntohs(address.sin_port));
    return bound;
}

static void begin_server(Server *server)
{
    *server = (Server){.listening = -1};
    server->listening = bind_free(server->port);
    assert_int_equal(listen(server->listening, 1), 0);
    assert_int_equal(pthread_create(&server->thread, NULL, listen_to_it, server), 0);
}

static void end_server(Server *server)
{
    pthread_join(server->thread, NULL);
    close(server->listening);
}

/* ---- reading packets ---- */

typedef struct Reader {
    const unsigned char *at, *end;
} Reader;

static uint64_t take(Reader *reader, unsigned n_bytes)
{
    uint64_t value = 0;
    assert_true(reader->end - reader->at >= n_bytes);
    for (unsigned i = 0; i < n_bytes; i++) value |= (uint64_t)reader->at[i] << (8 * i);
    reader->at += n_bytes;
    return value;
}

static void take_text(Reader *reader, const char *expected)
{
    assert_true(reader->end - reader->at > (ptrdiff_t)strlen(expected));
    assert_string_equal((const char *)reader->at, expected);
    reader->at += strlen(expected) + 1;
}

static float take_float(Reader *reader)
{
    uint32_t bits = (uint32_t)take(reader, 4);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* The next packet by itself, its length read. */
static Reader take_packet(Reader *all, unsigned type)
{
    Reader packet = {all->at, all->at + 4};
    size_t length = (size_t)take(&packet, 4);
    assert_true(length > 4 && (size_t)(all->end - all->at) >= length);
    packet.end = all->at + length;
    all->at += length;
    assert_int_equal(take(&packet, 1), type);
    return packet;
}

static void expect_end(const Reader *reader)
{
    assert_ptr_equal(reader->at, reader->end);
}

/* A packet that makes the picture, and packets that fill rows 0 to its height. */
static void expect_picture(Reader *all, const Image *image, bool first)
{
    if (first) {
        Reader packet = take_packet(all, 4);
        assert_int_equal(take(&packet, 1), 1); /* it is shown */
        take_text(&packet, "scene.mns");
        assert_int_equal(take(&packet, 4), image->width);
        assert_int_equal(take(&packet, 4), image->height);
        assert_int_equal(take(&packet, 4), image->n_channels);
        for (uint32_t c = 0; c < image->n_channels; c++) take_text(&packet, image->names[c]);
        expect_end(&packet);
    }
    for (uint32_t y = 0; y < image->height;) {
        Reader packet = take_packet(all, 6);
        assert_int_equal(take(&packet, 1), 0); /* what somebody looks at stays */
        take_text(&packet, "scene.mns");
        assert_int_equal(take(&packet, 4), image->n_channels);
        for (uint32_t c = 0; c < image->n_channels; c++) take_text(&packet, image->names[c]);
        assert_int_equal(take(&packet, 4), 0);
        assert_int_equal(take(&packet, 4), y);
        assert_int_equal(take(&packet, 4), image->width);
        uint32_t rows = (uint32_t)take(&packet, 4);
        uint64_t offsets[8], strides[8];
        for (uint32_t c = 0; c < image->n_channels; c++) offsets[c] = take(&packet, 8);
        for (uint32_t c = 0; c < image->n_channels; c++) strides[c] = take(&packet, 8);
        const unsigned char *data = packet.at;
        assert_int_equal(packet.end - data, 4 * (size_t)rows * image->width * image->n_channels);
        for (uint32_t i = 0; i < rows * image->width; i++)
            for (uint32_t c = 0; c < image->n_channels; c++) {
                Reader value = {data + 4 * (offsets[c] + i * strides[c]), packet.end};
                if (take_float(&value) != image_at(image, i % image->width, y + i / image->width)[c])
                    fail_msg("another value");
            }
        y += rows;
    }
}

static void make_image(uint32_t width, uint32_t height, Image *image)
{
    static const char *const names[] = {"R", "G", "B", "A"};
    Error error;
    assert_int_equal(image_new(width, height, names, 4, image, &error), STATUS_OK);
    for (size_t i = 0; i < 4 * (size_t)width * height; i++) image->pixels[i] = (float)i * .37f - 1;
}

/* ---- tests ---- */

static void pictures_arrive(void **state)
{
    (void)state;
    Server server;
    Tev *tev;
    Error error;
    Image small, large;
    make_image(5, 3, &small);
    make_image(700, 1600, &large); /* 4.5 million floats: in more than one packet */
    begin_server(&server);
    assert_int_equal(tev_open("127.0.0.1", server.port, "scene.mns", &tev, &error), STATUS_OK);
    assert_int_equal(tev_show(tev, &small, &error), STATUS_OK);
    small.pixels[7] = 1e30f;
    assert_int_equal(tev_show(tev, &small, &error), STATUS_OK);
    tev_close(tev);
    end_server(&server);
    Reader all = {server.bytes, server.bytes + server.length};
    small.pixels[7] = 7 * .37f - 1;
    expect_picture(&all, &small, true);
    small.pixels[7] = 1e30f;
    expect_picture(&all, &small, false);
    expect_end(&all);
    free(server.bytes);
    begin_server(&server);
    assert_int_equal(tev_open("localhost", server.port, "scene.mns", &tev, &error), STATUS_OK);
    assert_int_equal(tev_show(tev, &small, &error), STATUS_OK);
    assert_int_equal(tev_show(tev, &large, &error), STATUS_OK);
    tev_close(tev);
    end_server(&server);
    all = (Reader){server.bytes, server.bytes + server.length};
    expect_picture(&all, &small, true);
    Reader closing = take_packet(&all, 2);
    take_text(&closing, "scene.mns");
    expect_end(&closing);
    expect_picture(&all, &large, true);
    expect_end(&all);
    free(server.bytes);
    image_clear(&small);
    image_clear(&large);
}

static void nobody_is_there(void **state)
{
    (void)state;
    char port[16];
    Tev *tev;
    Error error;
    close(bind_free(port)); /* one that nobody listens at */
    assert_int_equal(tev_open("127.0.0.1", port, "scene.mns", &tev, &error), STATUS_OUTPUT);
    assert_null(tev);
    assert_non_null(strstr(error.text, "no tev takes pictures at 127.0.0.1:"));
    assert_int_equal(tev_open("no.such.host.invalid", "14158", "scene.mns", &tev, &error), STATUS_OUTPUT);
    assert_non_null(strstr(error.text, "no tev takes pictures at no.such.host.invalid:14158"));
}

/* A viewer that goes away in between is no reason to die by SIGPIPE. */
static void it_goes_away(void **state)
{
    (void)state;
    char port[16];
    int listening = bind_free(port);
    assert_int_equal(listen(listening, 1), 0);
    Tev *tev;
    Error error;
    Image image;
    make_image(400, 400, &image);
    assert_int_equal(tev_open("127.0.0.1", port, "scene.mns", &tev, &error), STATUS_OK);
    int connection = accept(listening, NULL, NULL);
    close(connection);
    Status status = STATUS_OK;
    for (int i = 0; i < 50 && status == STATUS_OK; i++) status = tev_show(tev, &image, &error);
    assert_int_equal(status, STATUS_OUTPUT);
    assert_non_null(strstr(error.text, "takes no more pictures"));
    tev_close(tev);
    close(listening);
    image_clear(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_arrive),
        cmocka_unit_test(nobody_is_there),
        cmocka_unit_test(it_goes_away),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
