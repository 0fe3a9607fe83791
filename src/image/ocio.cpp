/* ocio.cpp - colour management through OpenColorIO, which has no C interface: the only C++ file.
 * Every function has C linkage and lets no exception out. What OpenColorIO would print goes nowhere; what it
 * throws becomes the Error's text.
 * SPDX-License-Identifier: Apache-2.0 */
#include <OpenColorIO/OpenColorIO.h>

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <sstream>
#include <string>
#include <vector>

extern "C" {
#include "image/config.h"
#include "image/view.h"
}

namespace OCIO = OCIO_NAMESPACE;

struct ColorConfig {
    OCIO::ConstConfigRcPtr config;
    std::string space;                         /* the config's space in which views begin and inputs end */
    OCIO::ConstCPUProcessorRcPtr from_working; /* linear Rec.709 to space and back; null when they are the same */
    OCIO::ConstCPUProcessorRcPtr to_working;
};

namespace
{

const float largest = 65504.0f; /* larger values come out of the ACES views black */
const size_t block_pixels = 8192;
const char *const working_space = "lin_rec709";

/* Names under which configurations keep linear Rec.709, D65: our own, ACES 2.x, ACES 1.x. */
const char *const working_names[] = {"lin_rec709", "Linear Rec.709 (sRGB)", "lin_srgb", "Utility - Linear - sRGB",
                                     "lin_rec709_srgb"};

/* A message on one line and without its full stop, as all our messages are. */
void straighten(char *text)
{
    size_t length = std::strlen(text);
    std::replace(text, text + length, '\n', ' ');
    while (length > 0 && (text[length - 1] == '.' || text[length - 1] == ' ')) text[--length] = 0;
}

/* Runs task and turns what it throws into a failure: "cannot DO 'WHAT': reason". */
template <typename Task> Status guarded(Error *error, const char *doing, const char *what, Task task)
{
    try {
        return task();
    } catch (const std::bad_alloc &) {
        return fail(error, STATUS_NOMEM, "cannot %s '%s': out of memory", doing, what);
    } catch (const std::exception &exception) {
        /* "Error: Loading the OCIO profile 'NAME' failed. REASON" says twice what we say ourselves */
        const char *reason = std::strstr(exception.what(), "' failed. ");
        fail(error, STATUS_INPUT, "cannot %s '%s': %s", doing, what, reason ? reason + 10 : exception.what());
        if (error) straighten(error->text);
        return STATUS_INPUT;
    } catch (...) {
        return fail(error, STATUS_INPUT, "cannot %s '%s'", doing, what);
    }
}

/* For the functions that give a name or nothing. */
template <typename Task> const char *name_or_null(Task task)
{
    try {
        const char *name = task();
        return name && *name ? name : nullptr;
    } catch (...) {
        return nullptr;
    }
}

std::string lower(const std::string &text)
{
    std::string result = text;
    for (char &c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

/* Levenshtein's distance. */
size_t edit_distance(const std::string &a, const std::string &b)
{
    std::vector<size_t> row(b.size() + 1);
    for (size_t j = 0; j <= b.size(); j++) row[j] = j;
    for (size_t i = 1; i <= a.size(); i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= b.size(); j++) {
            size_t kept = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1])});
            diagonal = kept;
        }
    }
    return row[b.size()];
}

/* The name that is meant: the same but for capitals. Otherwise empty, and *hint, for behind a message, is the one that is
 * near enough to be meant, or all of them where they are few. */
std::string match_name(const std::string &wanted, const std::vector<std::string> &names, std::string *hint)
{
    const size_t few = 8;
    size_t best = wanted.size() / 2 + 1;
    hint->clear();
    for (const std::string &name : names) {
        size_t distance = edit_distance(lower(wanted), lower(name));
        if (distance == 0) return name;
        if (distance >= best) continue;
        best = distance;
        *hint = "; did you mean '" + name + "'?";
    }
    if (!hint->empty() || names.size() > few) return std::string();
    for (const std::string &name : names) *hint += (hint->empty() ? "; there is '" : ", '") + name + "'";
    return std::string();
}

std::vector<std::string> displays_of(const OCIO::ConstConfigRcPtr &config)
{
    std::vector<std::string> names;
    for (int i = 0; i < config->getNumDisplays(); i++) names.emplace_back(config->getDisplay(i));
    return names;
}

std::vector<std::string> views_of(const OCIO::ConstConfigRcPtr &config, const std::string &display)
{
    std::vector<std::string> names;
    for (int i = 0; i < config->getNumViews(display.c_str()); i++)
        names.emplace_back(config->getView(display.c_str(), i));
    return names;
}

std::vector<std::string> spaces_of(const OCIO::ConstConfigRcPtr &config)
{
    std::vector<std::string> names;
    for (int i = 0; i < config->getNumColorSpaces(); i++) names.emplace_back(config->getColorSpaceNameByIndex(i));
    return names;
}

OCIO::ConstConfigRcPtr built_in_config()
{
    std::stringstream text;
    for (const char *const *line = color_config_lines; *line; line++) text << *line;
    return OCIO::Config::CreateFromStream(text);
}

OCIO::ConstCPUProcessorRcPtr cpu_of(const OCIO::ConstProcessorRcPtr &processor)
{
    OCIO::ConstCPUProcessorRcPtr cpu = processor->getDefaultCPUProcessor();
    return cpu->isNoOp() ? OCIO::ConstCPUProcessorRcPtr() : cpu;
}

void apply(const OCIO::ConstCPUProcessorRcPtr &processor, float *rgb, size_t n_pixels)
{
    if (!processor) return;
    OCIO::PackedImageDesc pixels(rgb, static_cast<long>(n_pixels), 1, 3);
    processor->apply(pixels);
}

/* Finds out how the working space reaches the config: by a name that it is known under, else through the
 * interchange space that both have. */
Status connect(ColorConfig *color, const char *label, Error *error)
{
    for (const char *name : working_names) {
        OCIO::ConstColorSpaceRcPtr space = color->config->getColorSpace(name);
        if (!space) continue;
        color->space = space->getName();
        return STATUS_OK;
    }
    if (!color->config->hasRole(OCIO::ROLE_SCENE_LINEAR))
        return fail(error, STATUS_INPUT, "the OpenColorIO config '%s' has no role scene_linear", label);
    if (!color->config->hasRole(OCIO::ROLE_INTERCHANGE_SCENE))
        return fail(error, STATUS_INPUT,
                    "the OpenColorIO config '%s' does not tell where linear Rec.709 is: it has neither the role "
                    "aces_interchange nor a color space named 'Linear Rec.709 (sRGB)', 'lin_rec709', 'lin_srgb' or "
                    "'Utility - Linear - sRGB'",
                    label);
    color->space = color->config->getColorSpace(OCIO::ROLE_SCENE_LINEAR)->getName();
    OCIO::ConstConfigRcPtr ours = built_in_config();
    color->from_working =
        cpu_of(OCIO::Config::GetProcessorFromConfigs(ours, working_space, color->config, color->space.c_str()));
    color->to_working =
        cpu_of(OCIO::Config::GetProcessorFromConfigs(color->config, color->space.c_str(), ours, working_space));
    return STATUS_OK;
}

/* Resolves the display and the view, which may be NULL for the defaults. */
Status choose_view(const ColorConfig *color, const char *display, const char *view, std::string *display_name,
                   std::string *view_name, Error *error)
{
    std::string hint;
    std::string wanted = display ? display : color->config->getDefaultDisplay();
    *display_name = match_name(wanted, displays_of(color->config), &hint);
    if (display_name->empty())
        return fail(error, STATUS_USAGE, "there is no display '%s'%s", wanted.c_str(), hint.c_str());
    wanted = view ? view : color->config->getDefaultView(display_name->c_str());
    *view_name = match_name(wanted, views_of(color->config, *display_name), &hint);
    if (view_name->empty())
        return fail(error, STATUS_USAGE, "the display '%s' has no view '%s'%s", display_name->c_str(), wanted.c_str(),
                    hint.c_str());
    return STATUS_OK;
}

OCIO::ConstCPUProcessorRcPtr view_processor(const ColorConfig *color, const std::string &display,
                                            const std::string &view)
{
    OCIO::DisplayViewTransformRcPtr transform = OCIO::DisplayViewTransform::Create();
    transform->setSrc(color->space.c_str());
    transform->setDisplay(display.c_str());
    transform->setView(view.c_str());
    return cpu_of(color->config->getProcessor(transform));
}

float scrubbed(float v)
{
    return std::isnan(v) ? 0.0f : std::min(largest, std::max(-largest, v));
}

float held(float v)
{
    return v > 0 ? std::min(v, 1.0f) : 0.0f; /* not a number: 0 */
}

void view_pixels(const ColorConfig *color, const OCIO::ConstCPUProcessorRcPtr &processor, const int channels[3],
                 Image *image)
{
    std::vector<float> block(3 * block_pixels);
    size_t n_pixels = static_cast<size_t>(image->width) * image->height;
    for (size_t first = 0; first < n_pixels; first += block_pixels) {
        size_t n = std::min(block_pixels, n_pixels - first);
        float *pixels = image->pixels + first * image->n_channels;
        for (size_t i = 0; i < n; i++)
            for (size_t c = 0; c < 3; c++)
                block[3 * i + c] = scrubbed(pixels[i * image->n_channels + static_cast<size_t>(channels[c])]);
        apply(color->from_working, block.data(), n);
        apply(processor, block.data(), n);
        for (size_t i = 0; i < n; i++)
            for (size_t c = 0; c < 3; c++)
                pixels[i * image->n_channels + static_cast<size_t>(channels[c])] = held(block[3 * i + c]);
    }
}

} // namespace

extern "C" Status color_config_open(const char *config, ColorConfig **out, Error *error)
{
    *out = nullptr;
    const char *variable = std::getenv("OCIO");
    if (!config && variable && *variable) config = variable;
    ColorConfig *color = nullptr;
    const char *label = config ? config : "built-in";
    struct stat facts; /* yaml-cpp loses memory on a directory */
    if (config && stat(config, &facts) != 0 && std::strncmp(config, "ocio://", 7) != 0)
        return fail(error, STATUS_INPUT, "cannot read the OpenColorIO config '%s': %s", config, std::strerror(errno));
    if (config && stat(config, &facts) == 0 && S_ISDIR(facts.st_mode))
        return fail(error, STATUS_INPUT, "cannot read the OpenColorIO config '%s': it is a directory", config);
    Status status = guarded(error, "read the OpenColorIO config", label, [&]() {
        OCIO::SetLoggingFunction([](const char *) {});
        color = new ColorConfig;
        color->config = config ? OCIO::Config::CreateFromFile(config) : built_in_config();
        color->config->validate();
        return connect(color, label, error);
    });
    if (status == STATUS_OK)
        *out = color;
    else
        delete color;
    return status;
}

extern "C" void color_config_close(ColorConfig *config)
{
    delete config;
}

extern "C" const char *color_config_display(const ColorConfig *config, int index)
{
    return name_or_null([=]() {
        return index >= 0 && index < config->config->getNumDisplays() ? config->config->getDisplay(index) : nullptr;
    });
}

extern "C" const char *color_config_view(const ColorConfig *config, const char *display, int index)
{
    return name_or_null([=]() {
        return index >= 0 && index < config->config->getNumViews(display) ? config->config->getView(display, index)
                                                                          : nullptr;
    });
}

extern "C" const char *color_config_default_display(const ColorConfig *config)
{
    return name_or_null([=]() { return config->config->getDefaultDisplay(); });
}

extern "C" const char *color_config_default_view(const ColorConfig *config, const char *display)
{
    return name_or_null([=]() { return config->config->getDefaultView(display); });
}

static void brighten(const int channels[3], double stops, Image *image)
{
    const float factor = (float)std::exp2(stops);
    const size_t n = (size_t)image->width * image->height;
    const int distinct = channels[0] == channels[1] ? 1 : 3; /* one channel for all three */
    for (size_t i = 0; stops != 0 && i < n; i++)
        for (int c = 0; c < distinct; c++) image->pixels[i * image->n_channels + (size_t)channels[c]] *= factor;
}

extern "C" Status color_view(const ColorConfig *config, const ColorLook *look, Image *image, Error *error)
{
    return guarded(error, "make the view", look->view ? look->view : "default", [&]() {
        int channels[3];
        if (!image_rgb(image, channels))
            return fail(error, STATUS_USAGE, "the picture has no channels R, G and B to view");
        std::string display_name, view_name;
        TRY(choose_view(config, look->display, look->view, &display_name, &view_name, error));
        brighten(channels, look->exposure.stops, image);
        view_pixels(config, view_processor(config, display_name, view_name), channels, image);
        return STATUS_OK;
    });
}

extern "C" Status color_to_working(const ColorConfig *config, const char *space, float *rgb, size_t n_pixels,
                                   Error *error)
{
    return guarded(error, "convert from the color space", space, [&]() {
        OCIO::ConstColorSpaceRcPtr from = config->config->getColorSpace(space); /* by name, alias or role */
        if (!from) {
            std::string hint;
            match_name(space, spaces_of(config->config), &hint);
            return fail(error, STATUS_USAGE, "there is no color space '%s'%s", space, hint.c_str());
        }
        if (from->isData()) return STATUS_OK;
        OCIO::ConstCPUProcessorRcPtr processor =
            cpu_of(config->config->getProcessor(from->getName(), config->space.c_str()));
        for (size_t first = 0; first < n_pixels; first += block_pixels) {
            size_t n = std::min(block_pixels, n_pixels - first);
            apply(processor, rgb + 3 * first, n);
            apply(config->to_working, rgb + 3 * first, n);
        }
        return STATUS_OK;
    });
}
