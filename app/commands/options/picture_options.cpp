#include "app/commands/options/picture_options.h"

#include "app/commands/options/option_values.h"
#include "app/view/camera_text.h"
#include "app/view/values/color_maps.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace gs::app {
namespace {

using OptionProblem = std::optional<std::string>;

constexpr double kMostDots = 20000;

struct PaperUnit {
  std::string_view name;
  double millimetres;
};
constexpr std::array<PaperUnit, 3> kPaperUnits{{{"mm", 1}, {"cm", 10}, {"in", 25.4}}};

std::optional<glm::vec3> read_hexadecimal(std::string_view digits) {
  unsigned rgb = 0;
  const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), rgb, 16);
  if (digits.size() != 6 || result.ptr != digits.data() + digits.size() || result.ec != std::errc())
    return std::nullopt;
  return glm::vec3(rgb >> 16, rgb >> 8 & 255, rgb & 255) / 255.0f;
}

}  // namespace

std::optional<glm::dvec2> read_paper(std::string_view text) {
  for (const PaperUnit& unit : kPaperUnits) {
    if (!text.ends_with(unit.name)) continue;
    text.remove_suffix(unit.name.size());
    double size[2];
    if (!read_list(text, 'x', size) || !(size[0] > 0 && size[1] > 0)) return std::nullopt;
    return glm::dvec2(size[0], size[1]) * unit.millimetres;
  }
  return std::nullopt;
}

std::optional<glm::vec3> read_color(std::string_view text) {
  if (text.starts_with('#')) return read_hexadecimal(text.substr(1));
  double rgb[3];
  if (!read_list(text, ',', rgb) || std::any_of(rgb, rgb + 3, [](double c) { return c < 0 || c > 1; }))
    return std::nullopt;
  return glm::vec3(rgb[0], rgb[1], rgb[2]);
}

std::optional<std::string> read_stereo(std::string_view text, PictureRequest& request) {
  request.stereo = text == "side-by-side" ? render::Stereo::side_by_side : render::Stereo::anaglyph;
  if (text == "side-by-side" || text == "anaglyph") return std::nullopt;
  return "expected side-by-side or anaglyph";
}

std::optional<std::string> read_eye_distance(std::string_view text, PictureRequest& request) {
  if (read(text, request.eye_distance) && request.eye_distance > 0 && std::isfinite(request.eye_distance))
    return std::nullopt;
  return "expected a length, more than 0";
}

std::optional<std::string> read_dots(std::string_view text, PictureRequest& request) {
  if (read(text, request.dots_per_inch) && request.dots_per_inch >= 1 && request.dots_per_inch <= kMostDots)
    return std::nullopt;
  return "expected dots an inch, from 1 to 20000";
}

std::optional<std::pair<double, double>> read_times(std::string_view text) {
  constexpr double kLongest = 86400;
  const std::size_t dots = text.find("..");
  double from = 0, to = 0;
  if (dots == std::string_view::npos || !read(text.substr(0, dots), from) || !read(text.substr(dots + 2), to))
    return std::nullopt;
  return from >= 0 && from < to && to <= kLongest ? std::optional(std::pair{from, to}) : std::nullopt;
}

namespace {

OptionProblem set_background(Options& options, const std::string& value) {
  options.picture.transparent = value == "transparent";
  options.backdrop = value == "gradient";
  if (options.picture.transparent || options.backdrop) return {};
  options.background = read_color(value);
  return options.background ? OptionProblem{}
                            : "expected transparent, gradient, #rrggbb, or RED,GREEN,BLUE, each from 0 to 1";
}

OptionProblem set_slice(Options& options, const std::string& value) {
  const auto wish = read_slice_wish(value);
  if (wish) options.slices.push_back(*wish);
  return wish ? OptionProblem{} : "expected x=, y= or z= with a voxel from 0 on, or a part like 50%";
}

OptionProblem set_window(Options& options, const std::string& value) {
  double ends[2];
  if (!read_list(value, ',', ends) || !(ends[0] < ends[1])) return "expected LOW,HIGH, the second one larger";
  options.slice_look.window = {static_cast<float>(ends[0]), static_cast<float>(ends[1])};
  return {};
}

OptionProblem set_slice_map(Options& options, const std::string& value) {
  options.slice_look.map = value;
  return find_color_map(value) ? OptionProblem{} : "expected one of " + color_map_names();
}

OptionProblem set_tour(Options& options, const std::string& value) {
  const bool good = each_of(value, [&](const std::string& name) {
    options.animation.tour.push_back(name);
    return !name.empty();
  });
  return good && options.animation.tour.size() > 1 ? OptionProblem{}
                                                   : "expected two Viewpoints or more, parted by commas";
}

OptionProblem set_pictures(Options& options, const std::string& value) {
  return read(value, options.animation.pictures) && options.animation.pictures > 0
             ? OptionProblem{}
             : "expected a number of pictures, more than 0";
}

OptionProblem set_picture_rate(Options& options, const std::string& value) {
  return read(value, options.animation.rate) && options.animation.rate >= 0.1 && options.animation.rate <= 240
             ? OptionProblem{}
             : "expected pictures a second, from 0.1 to 240";
}

OptionProblem set_animation_length(Options& options, const std::string& value) {
  return read(value, options.animation.length) && options.animation.length > 0 && options.animation.length <= 86400
             ? OptionProblem{}
             : "expected seconds, more than 0";
}

OptionProblem set_up(Options& options, const std::string& value) {
  options.up = find_up_axis(value);
  if (options.up) return {};
  std::string names;
  for (const UpAxisRow& row : up_axes()) names += (names.empty() ? "expected " : ", ") + std::string(row.name);
  return names;
}

OptionProblem set_display(Options& options, const std::string& value) {
  static constexpr std::string_view kModes[] = {"surface", "edges", "wireframe", "points"};
  const auto* const found = std::find(std::begin(kModes), std::end(kModes), value);
  if (found == std::end(kModes)) return "expected surface, edges, wireframe or points";
  options.display = static_cast<render::DisplayMode>(found - std::begin(kModes));
  return {};
}

OptionProblem set_camera(Options& options, const std::string& value) {
  auto camera = read_camera(value);
  if (auto* problem = std::get_if<std::string>(&camera)) return std::move(*problem);
  options.camera = std::get<Pose>(camera);
  return {};
}

constexpr OptionRow kPictureOptions[] = {
    {"--camera", "POSE", "",
     "look from there: position=X,Y,Z orientation=X,Y,Z,RADIANS fieldOfView=RADIANS, and height=H for parallel rays, "
     "or the text of a Viewpoint; Copy camera in the window's menu gives both",
     "open animate ", set_camera},
    {"--display", "surface|edges|wireframe|points", "surface",
     "how faces are drawn: surface, edges (with the edges of their triangles), wireframe or points; clouds of discs "
     "and "
     "volumes stay as they are",
     "open animate ", set_display},
    {"--up", "AXIS", "auto",
     "what is up: x, -x, y, -y, z or -z; auto: as the file says, or as its format has it (docs/formats.md). --orbit "
     "and "
     "--turntable follow it; encode writes it into streams",
     "open animate encode ", set_up},
    {"--orthographic", "", "", "parallel rays, without perspective", "open animate ",
     [](Options& o, const std::string&) {
       o.orthographic = true;
       return OptionProblem{};
     }},
    {"--background", "COLOR", "",
     "one colour in place of the world's Background: R,G,B from 0 to 1, #rrggbb; gradient: a neutral one; or, of a "
     "picture, transparent",
     "open animate ", set_background},
    {"--stereo", "side-by-side|anaglyph", "",
     "a picture for two eyes: one half for each, or red for the left one and green and blue for the right one",
     "open animate ", [](Options& o, const std::string& v) { return read_stereo(v, o.picture); }},
    {"--eye-distance", "LENGTH", "",
     "between the eyes, in metres of the world; by itself a thirtieth of the distance to its middle", "open animate ",
     [](Options& o, const std::string& v) { return read_eye_distance(v, o.picture); }},
    {"--dpi", "N", "",
     "of a picture that is printed: dots an inch, which the file tells (300 for sizes in mm, cm or in)",
     "open animate ", [](Options& o, const std::string& v) { return read_dots(v, o.picture); }},
    {"--color-bar", "", "", "a bar beside a volume that says what its colours stand for", "open animate ",
     [](Options& o, const std::string&) {
       o.picture.color_bar = true;
       return OptionProblem{};
     }},
    {"--transfer", "MAP|FILE", "",
     "colours and opacities of volumes: a colour map (grey, viridis, cividis, inferno, magma, turbo, coolwarm) or a "
     "JSON file that was saved in the window",
     "open animate ",
     [](Options& o, const std::string& v) {
       o.transfer = v;
       return v.empty() ? OptionProblem("expected a colour map or a file") : OptionProblem{};
     }},
    {"--slice", "AXIS=PLACE", "",
     "show a plane of a volume's voxels: x=, y= or z= with a voxel from 0 on, or a part like 50%; once for each axis",
     "open animate ", set_slice, true},
    {"--slices-alone", "", "", "show the planes without the volume", "open animate ",
     [](Options& o, const std::string&) {
       o.slice_look.alone = true;
       return OptionProblem{};
     }},
    {"--window", "LOW,HIGH", "", "the values that have the first and the last colour of a plane", "open animate ",
     set_window},
    {"--slice-map", "grey|viridis|cividis|inferno|magma|turbo|coolwarm", "grey", "the colour map of the planes",
     "open animate ", set_slice_map},
    {"--turntable", "", "", "turn once about the up axis", "animate ",
     [](Options& o, const std::string&) {
       o.animation.turntable = true;
       return OptionProblem{};
     }},
    {"--during", "FROM..TO", "", "seconds of the world's own time that go by", "animate ",
     [](Options& o, const std::string& v) {
       o.animation.times = read_times(v);
       return o.animation.times ? OptionProblem{}
                                : OptionProblem("expected FROM..TO in seconds, from 0 to 86400: 0..10");
     }},
    {"--tour", "NAME,NAME,...", "", "go from Viewpoint to Viewpoint, by description, DEF name or number (from 1)",
     "animate ", set_tour},
    {"--frames", "N", "", "so many pictures in all", "animate ", set_pictures},
    {"--fps", "N", "25", "pictures a second; files a second of a series like run.%04d.vti", "open animate ",
     set_picture_rate},
    {"--seconds", "S", "", "of a turntable (8), or from one Viewpoint to the next (3)", "animate ",
     set_animation_length},
};

}  // namespace

std::span<const OptionRow> picture_option_rows() { return kPictureOptions; }

}  // namespace gs::app
