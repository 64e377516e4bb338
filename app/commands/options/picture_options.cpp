#include "app/commands/options/picture_options.h"

#include "app/commands/options/option_values.h"
#include "app/commands/options/setters.h"
#include "app/formats/volume/volume_common.h"
#include "app/view/camera_text.h"
#include "app/view/values/color_maps.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace gs::app {
namespace {

constexpr double kMaxDots = 20000;

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
  return "expected a length above 0";
}

std::optional<std::string> read_dots(std::string_view text, PictureRequest& request) {
  if (read(text, request.dots_per_inch) && request.dots_per_inch >= 1 && request.dots_per_inch <= kMaxDots)
    return std::nullopt;
  return "expected dots per inch, from 1 to 20000";
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

Problem set_background(PictureOptions& options, const std::string& value) {
  options.picture.transparent = value == "transparent";
  options.background.reset();
  options.backdrop.reset();
  if (value == "gradient" || value == "world") options.backdrop = value == "gradient";
  if (options.picture.transparent || options.backdrop) return {};
  options.background = read_color(value);
  return options.background ? Problem{}
                            : "expected transparent, gradient, world, #rrggbb, or RED,GREEN,BLUE, each from 0 to 1";
}

Problem set_slice(PictureOptions& options, const std::string& value) {
  const auto wish = read_slice_wish(value);
  if (wish) options.volume.slices.push_back(*wish);
  return wish ? Problem{} : "expected x=, y= or z= with a voxel number from 0, or a percentage such as 50%";
}

Problem set_window(PictureOptions& options, const std::string& value) {
  double ends[2];
  if (!read_list(value, ',', ends) || !(ends[0] < ends[1])) return "expected LOW,HIGH with LOW below HIGH";
  options.volume.slice_look.window = {static_cast<float>(ends[0]), static_cast<float>(ends[1])};
  return {};
}

Problem set_slice_map(PictureOptions& options, const std::string& value) {
  options.volume.slice_look.map = value;
  return find_color_map(value) ? Problem{} : "expected one of " + color_map_names();
}

Problem set_projection(PictureOptions& options, const std::string& value) {
  const VolumeModeRow* mode = find_volume_mode(value);
  if (mode) options.volume.display.mode = mode->mode;
  return mode ? Problem{} : "expected maximum, minimum, average or vectors";
}

Problem set_tour(PictureOptions& options, const std::string& value) {
  const bool good = each_of(value, [&](const std::string& name) {
    options.animation.tour.push_back(name);
    return !name.empty();
  });
  return good && options.animation.tour.size() > 1 ? Problem{}
                                                   : "expected at least two Viewpoints, separated by commas";
}

Problem set_pictures(PictureOptions& options, const std::string& value) {
  return read(value, options.animation.pictures) && options.animation.pictures > 0
             ? Problem{}
             : "expected a number of pictures above 0";
}

Problem set_picture_rate(PictureOptions& options, const std::string& value) {
  return read(value, options.animation.rate) && options.animation.rate >= 0.1 && options.animation.rate <= 240
             ? Problem{}
             : "expected pictures per second, from 0.1 to 240";
}

Problem set_animation_length(PictureOptions& options, const std::string& value) {
  return read(value, options.animation.length) && options.animation.length > 0 && options.animation.length <= 86400
             ? Problem{}
             : "expected seconds above 0";
}

Problem set_up(UpOption& options, const std::string& value) {
  options.up = find_up_axis(value);
  if (options.up) return {};
  std::string names;
  for (const UpAxisRow& row : up_axes()) names += (names.empty() ? "expected " : ", ") + std::string(row.name);
  return names;
}

Problem set_display(PictureOptions& options, const std::string& value) {
  static constexpr std::string_view kModes[] = {"surface", "edges", "wireframe", "points"};
  const auto* const found = std::find(std::begin(kModes), std::end(kModes), value);
  if (found == std::end(kModes)) return "expected surface, edges, wireframe or points";
  options.display = static_cast<render::DisplayMode>(found - std::begin(kModes));
  return {};
}

Problem set_camera(PictureOptions& options, const std::string& value) {
  auto camera = read_camera(value);
  if (auto* problem = std::get_if<std::string>(&camera)) return std::move(*problem);
  options.camera = std::get<Pose>(camera);
  return {};
}

// Sets the component for loading, and for the values of pictures and windows.
Problem set_component(CommandOptions& options, const std::string& value) {
  const auto component = read_voxel_component(value);
  if (!component) return "expected the number of a component from 0, or magnitude";
  VoxelComponent& read = dynamic_cast<LoadOptions&>(options).component;
  read.index = component->index;
  read.magnitude = component->magnitude;
  read.chosen = true;
  if (auto* picture = dynamic_cast<PictureOptions*>(&options)) picture->volume.component = read;
  return {};
}

// Changes the choice of values for loading, and for the values of pictures and windows.
template <class Change>
Problem change_choice(CommandOptions& options, Change change) {
  VoxelComponent& read = dynamic_cast<LoadOptions&>(options).component;
  change(read);
  if (auto* picture = dynamic_cast<PictureOptions*>(&options)) picture->volume.component = read;
  return {};
}

Problem set_dataset(CommandOptions& options, const std::string& value) {
  if (value.empty()) return "expected the path of a dataset; info lists them";
  return change_choice(options, [&](VoxelComponent& choice) { choice.dataset = value; });
}

Problem set_channel(CommandOptions& options, const std::string& value) {
  std::size_t channel = 0;
  if (!read_count(value, channel)) return "expected an index from 0";
  return change_choice(options, [&](VoxelComponent& choice) { choice.channel = channel; });
}

Problem set_globe(CommandOptions& options, const std::string& value) {
  if (value != "yes" && value != "no" && value != "auto") return "expected yes, no or auto";
  return change_choice(options, [&](VoxelComponent& choice) {
    choice.globe = value == "auto" ? std::nullopt : std::optional(value == "yes");
  });
}

Problem set_flow(CommandOptions& options, const std::string& value) {
  static constexpr std::string_view kForms[] = {"values", "arrows", "streamlines"};
  const auto* const found = std::find(std::begin(kForms), std::end(kForms), value);
  if (found == std::end(kForms)) return "expected values, arrows or streamlines";
  return change_choice(
      options, [&](VoxelComponent& choice) { choice.flow = static_cast<FlowForm>(found - std::begin(kForms)); });
}

// Sets the colours of values on surfaces.
Problem set_surface_map(CommandOptions& options, const std::string& value) {
  const ColorMap* const map = find_color_map(value);
  if (!map) return "expected one of: " + color_map_names();
  return change_choice(options, [&](VoxelComponent& choice) { choice.colors.map = palette_of(*map); });
}

Problem set_surface_range(CommandOptions& options, const std::string& value) {
  using Range = SurfaceColors::Range;
  if (value == "whole" || value == "2-98%")
    return change_choice(options, [&](VoxelComponent& choice) {
      choice.colors.range = value == "whole" ? Range::whole : Range::contrast;
    });
  const std::vector<double> ends = numbers_of(value, 3);
  if (ends.size() != 2 || !(ends[0] < ends[1])) return "expected whole, 2-98% or LOW,HIGH";
  return change_choice(options, [&](VoxelComponent& choice) {
    choice.colors.range = Range::typed;
    choice.colors.low = ends[0];
    choice.colors.high = ends[1];
  });
}

// Sets whether voxels are labels, for loading, and for the values of pictures and windows.
Problem set_labels(CommandOptions& options, const std::string& value) {
  if (value != "yes" && value != "no" && value != "auto") return "expected yes, no or auto";
  VoxelComponent& read = dynamic_cast<LoadOptions&>(options).component;
  read.labels = value == "auto" ? std::nullopt : std::optional(value == "yes");
  if (auto* picture = dynamic_cast<PictureOptions*>(&options)) picture->volume.component = read;
  return {};
}

constexpr OptionRow kPictureOptions[] = {
    {"--camera", "POSE", "",
     "use this camera: position=X,Y,Z orientation=X,Y,Z,RADIANS fieldOfView=RADIANS, with height=H for parallel "
     "projection, or the text of a Viewpoint. Copy camera in the menu of a window writes both",
     "open animate ", with<set_camera>},
    {"--display", "surface|edges|wireframe|points", "surface",
     "display faces as surface, edges (surface and edges of triangles), wireframe or points; splats and volumes stay "
     "unchanged",
     "open animate ", with<set_display>},
    {"--up", "AXIS", "auto",
     "set the up axis: x, -x, y, -y, z, -z, or auto for the axis of the file or its format (docs/formats.md). --orbit "
     "and --turntable use it; encode stores it in streams",
     "open animate encode ", with<set_up>},
    {"--orthographic", "", "", "use parallel projection", "open animate ", flag<&PictureOptions::orthographic>},
    {"--background", "COLOR", "",
     "set the background: R,G,B from 0 to 1, #rrggbb, or for pictures gradient, world (the Background of the world) or "
     "transparent. Without this option, pictures of VRML97 worlds show their Background, other files a gradient",
     "open animate ", with<set_background>},
    {"--stereo", "side-by-side|anaglyph", "",
     "draw a picture for each eye: side by side, or red for the left and cyan for the right eye", "open animate ",
     with<[](PictureOptions& o, const std::string& v) { return read_stereo(v, o.picture); }>},
    {"--eye-distance", "LENGTH", "",
     "distance of the eyes in metres of the world (default: 1/30 of the distance to its centre)", "open animate ",
     with<[](PictureOptions& o, const std::string& v) { return read_eye_distance(v, o.picture); }>},
    {"--dpi", "N", "", "dots per inch for print, stored in the file (300 for sizes in mm, cm or in)", "open animate ",
     with<[](PictureOptions& o, const std::string& v) { return read_dots(v, o.picture); }>},
    {"--color-bar", "", "", "draw a bar with the values of the colours beside a volume", "open animate ",
     with<[](PictureOptions& o, const std::string&) {
       o.volume.color_bar = true;
       return Problem{};
     }>},
    {"--transfer", "MAP|FILE", "",
     "transfer function of volumes: a colour map (grey, viridis, cividis, inferno, magma, turbo, coolwarm) or a JSON "
     "file saved in the window",
     "open animate ", with<[](PictureOptions& o, const std::string& v) {
       o.volume.transfer = v;
       return v.empty() ? Problem("expected a colour map or a file") : Problem{};
     }>},
    {"--slice", "AXIS=PLACE", "",
     "show a plane of voxels: x=, y= or z= with a voxel number from 0, or a percentage such as 50%; once per axis",
     "open animate ", with<set_slice>, true},
    {"--slices-alone", "", "", "hide the volume and show only its planes", "open animate ",
     with<[](PictureOptions& o, const std::string&) {
       o.volume.slice_look.alone = true;
       return Problem{};
     }>},
    {"--window", "LOW,HIGH", "", "values of the first and last colour of planes and projections", "open animate ",
     with<set_window>},
    {"--slice-map", "grey|viridis|cividis|inferno|magma|turbo|coolwarm", "grey", "colour map of planes and projections",
     "open animate ", with<set_slice_map>},
    {"--projection", "maximum|minimum|average|vectors", "vectors",
     "draw the maximum, minimum or average of the values of a volume along each ray, or its vectors", "open animate ",
     with<set_projection>},
    {"--component", "N|magnitude", "0",
     "read this component of voxels with several numbers, such as colours or vectors: an index from 0, or magnitude, "
     "the length of the vector",
     "open animate encode export info ", set_component},
    {"--dataset", "PATH", "",
     "read this dataset of a file with several (HDF5, NetCDF, XDMF, TIFF), this array of a VTK surface, or this series "
     "of "
     "a DICOM folder: its path, or the end of it; info lists datasets",
     "open animate encode export info ", set_dataset},
    {"--channel", "N", "",
     "read this index, from 0, along the axes of a dataset that are neither space nor time nor components",
     "open animate encode export info ", set_channel},
    {"--flow", "values|arrows|streamlines", "values",
     "draw the vectors of a volume with two or three components as values (one component or the magnitude), as arrows "
     "on a thinned grid, or as streamlines; vectors at the points of a surface as values or arrows; colours show the "
     "length of the vectors",
     "open animate ", set_flow},
    {"--surface-map", "grey|viridis|cividis|inferno|magma|turbo|coolwarm", "viridis",
     "colour map of data on surfaces, arrows and streamlines", "open animate ", set_surface_map},
    {"--surface-range", "whole|2-98%|LOW,HIGH", "whole",
     "colour range of data on surfaces: all values, all but the lowest and highest 2 %, or the values from LOW to "
     "HIGH",
     "open animate ", set_surface_range},
    {"--globe", "yes|no|auto", "auto",
     "draw longitudes and latitudes as a globe instead of a plane; auto does so for meshes of the whole globe",
     "open animate encode export info ", set_globe},
    {"--labels", "yes|no|auto", "auto",
     "read the voxels as labels of a segmentation, which are never interpolated; auto follows the file (NIfTI, NRRD of "
     "3D Slicer)",
     "open animate encode export info ", set_labels},
    {"--turntable", "", "", "turn once about the up axis", "animate ", with<[](PictureOptions& o, const std::string&) {
       o.animation.turntable = true;
       return Problem{};
     }>},
    {"--during", "FROM..TO", "", "show these seconds of simulated time", "animate ",
     with<[](PictureOptions& o, const std::string& v) {
       o.animation.times = read_times(v);
       return o.animation.times ? Problem{} : Problem("expected FROM..TO in seconds, from 0 to 86400: 0..10");
     }>},
    {"--tour", "NAME,NAME,...", "", "go from Viewpoint to Viewpoint, by description, DEF name or number (from 1)",
     "animate ", with<set_tour>},
    {"--frames", "N", "", "total number of pictures", "animate ", with<set_pictures>},
    {"--fps", "N", "25", "pictures per second, or files per second of a series such as run.%04d.vti", "open animate ",
     with<set_picture_rate>},
    {"--seconds", "S", "", "duration of a turntable (8) or of each tour section (3)", "animate ",
     with<set_animation_length>},
};

}  // namespace

std::span<const OptionRow> picture_option_rows() { return kPictureOptions; }

}  // namespace gs::app
