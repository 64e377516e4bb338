#include "app/base/console.h"
#include "app/commands/common/conversion_report.h"
#include "app/commands/common/progress_bar.h"
#include "app/commands/common/shared.h"
#include "app/commands/common/vectors_of.h"
#include "app/commands/encode.h"
#include "app/encode/outline_model.h"
#include "app/encode/surface_triangles.h"
#include "app/formats/export/outline_text.h"
#include "app/formats/export/vrml_text.h"
#include "base/gzip.h"
#include "base/json_value.h"
#include "net/base/url.h"
#include "net/files/file.h"
#include "qnv/codecs/encode.h"
#include "qnv/codecs/outlines/outline_stream.h"
#include "qnv/container/container.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <limits>

namespace gs::app {
namespace {

// Default for the maximum deviation of a group from its plane, as a fraction of the model's diagonal.
constexpr double kOutlineTolerance = 1.0 / 200;

std::string_view extension(const std::string& path) {
  for (const std::string_view known : {".qnv", ".wrl", ".wrz"})
    if (path.ends_with(known)) return known;
  return {};
}

std::variant<OutlineModel, std::string> model_of(const EncodeCommand& options, const OpenedInput& input,
                                                 ProgressBar& progress) {
  if (const auto* opened = std::get_if<std::unique_ptr<OpenedSurface>>(&input.content)) {
    if (options.isovalue) return "is not a volume; --isovalue applies to volumes only";
    const Budget budget(options.limits);
    const std::uint64_t bytes = summarize_surface((*opened)->list).triangles * kOutlineTriangleBytes;
    if (bytes > budget.left(Resource::meshes)) return "has triangles that need " + budget.refusal(Resource::meshes);
    return outline_model((*opened)->list, texture_urls((*opened)->world));
  }
  if (const auto* mesh = std::get_if<MeshStream>(&input.content))
    return "has " + std::to_string(mesh->faces) +
           " faces, which exceed the memory limit; expected fewer, or a larger --memory";
  const qnv::VolumeSource* const volume = values_of(input);
  if (!volume) return "has no polygons; expected a world, a mesh, or a volume with --isovalue";
  if (!options.isovalue) return "is a volume; --method outlines needs --isovalue to select a surface";
  return isosurface_outlines(options, *volume, progress);
}

// Makes texture paths relative to the output file.
void make_relative(std::vector<qnv::OutlineAppearance>& appearances, const std::string& out) {
  namespace fs = std::filesystem;
  for (qnv::OutlineAppearance& look : appearances) {
    const std::string path = net::path_of_url(net::parse_url(look.texture_url));
    if (path.empty()) continue;
    std::error_code error;
    const fs::path relative = fs::relative(path, fs::absolute(out, error).parent_path(), error);
    if (!error && !relative.empty())
      look.texture_url = net::url_of_path("/" + relative.generic_string()).path.substr(1);
  }
}

void tell(const EncodeCommand& options, const qnv::OutlineGroups& groups, std::uint64_t in_bytes, std::size_t bytes,
          std::chrono::steady_clock::time_point start) {
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::size_t outlines = 0, inner = 0;
  for (const qnv::OutlineGroup& group : groups.groups) outlines += group.outline.size(), inner += group.inner.size();
  const qnv::OutlineCounts& counts = groups.counts;
  if (options.json) {
    const JsonValue facts = JsonValue::named({{"file", options.files[1]},
                                              {"source_polygons", counts.polygons},
                                              {"groups", groups.groups.size()},
                                              {"outline_polygons", outlines},
                                              {"inner_polygons", inner},
                                              {"invalid", counts.invalid},
                                              {"degenerate", counts.degenerate},
                                              {"duplicates", counts.duplicates},
                                              {"bytes", bytes},
                                              {"seconds", seconds}});
    print_text(facts.json());
    return;
  }
  print_conversion(
      {options.files[0], in_bytes, options.files[1], bytes,
       counted(counts.polygons, "polygon", "polygons") + " as " + counted(outlines, "outline", "outlines") + " of " +
           counted(groups.groups.size(), "group", "groups") + " and " +
           counted(inner, "inner polygon", "inner polygons")},
      start);
  if (counts.invalid + counts.degenerate + counts.duplicates > 0)
    print_line("left out: %zu polygons with invalid corners, %zu without area, %zu duplicates", counts.invalid,
               counts.degenerate, counts.duplicates);
}

}  // namespace

int encode_outlines(const EncodeCommand& options) {
  const std::string &in = options.files[0], &out = options.files[1];
  const auto start = std::chrono::steady_clock::now();
  const bool stream = extension(out) == ".qnv";
  static constexpr std::string_view kWorld = "#VRML V2.0 utf8\n";
  const auto first = stream ? qnv::encode_header({}) : std::vector<std::byte>();
  if (const auto refusal =
          refuse_to_replace(out, in, stream ? std::span<const std::byte>(first) : std::as_bytes(std::span(kWorld))))
    return fail(*refusal);
  ProgressBar progress;
  progress.whole().stage = "reading";
  const auto input = open_input(options, in, MeshForm::world);
  if (!input) return kFailed;
  auto built = model_of(options, *input, progress);
  if (const auto* problem = std::get_if<std::string>(&built)) return fail(in + " " + *problem);
  auto& model = std::get<OutlineModel>(built);
  qnv::OutlineOptions settings;
  const double diagonal = qnv::model_diagonal(model.model);
  settings.outline_tolerance = options.tolerance.value_or(kOutlineTolerance * diagonal);
  settings.tolerance = settings.outline_tolerance;
  if (options.groups > 0) {
    // The number of groups has priority: groups may be far from flat.
    settings.groups = options.groups;
    settings.tolerance = options.tolerance.value_or(std::numeric_limits<double>::infinity());
    settings.angle = 1.5;
  }
  settings.merge_tolerance = options.merge;
  auto grouped = qnv::group_outlines(model.model, settings, &progress.whole());
  if (progress.cancelled()) return fail("cancelled; " + out + " was not written");
  if (const auto* problem = std::get_if<qnv::OutlineError>(&grouped)) return fail(in + ": " + problem->message);
  const auto& groups = std::get<qnv::OutlineGroups>(grouped);
  if (groups.groups.empty()) return fail(in + ": no polygon has an area");
  make_relative(model.appearances, out);
  const Upright upright = wanted_upright(options, *input);
  std::vector<std::byte> bytes;
  if (stream) {
    qnv::OutlineEncodeOptions encode;
    encode.position_bits = options.position_bits;
    if (options.max_bytes_given) encode.max_bytes = options.max_bytes;
    encode.metadata = {{"title", input->title}};
    for (auto& pair : metadata_of(upright)) encode.metadata.push_back(std::move(pair));
    auto encoded = qnv::encode(qnv::OutlineSource{groups, model.appearances, encode}, {});
    if (const auto* problem = std::get_if<qnv::EncodeError>(&encoded)) return fail(in + ": " + problem->message);
    bytes = std::move(std::get<qnv::Encoding>(encoded).stream.bytes);
  } else {
    // With the axes of VRML97, the default Viewpoint is good.
    Box box;
    for (const glm::vec3& position : model.model.positions) box.add(position);
    bytes = outline_world(groups, model.appearances, input->title,
                          upright == Upright{} ? std::string() : front_viewpoint(box, upright));
    if (out.ends_with(".wrz")) bytes = gzip(bytes);
  }
  if (const auto problem = net::write_file_atomically(out, bytes)) return fail_to_write(problem->message);
  if (model.omitted > 0)
    complain("%s: warning: %zu Shapes of lines or points are left out, because they have no outlines", in.c_str(),
             model.omitted);
  if (model.averaged) complain("%s: warning: colours that vary within a face are averaged", in.c_str());
  progress.hide();
  tell(options, groups, input->bytes, bytes.size(), start);
  return kDone;
}

}  // namespace gs::app
