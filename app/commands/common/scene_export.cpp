#include "app/commands/common/scene_export.h"

#include "app/base/console.h"
#include "app/commands/common/conversion_report.h"
#include "app/commands/common/shared.h"
#include "app/formats/content_types.h"
#include "app/loading/world_loader.h"
#include "app/saving/save_formats.h"
#include "app/saving/scene_text.h"
#include "base/gzip.h"
#include "net/base/url.h"
#include "net/files/file.h"

#include <chrono>
#include <cstddef>
#include <span>
#include <variant>
#include <vector>

namespace gs::app {
namespace {

// Returns the type of a file, that of a server by its name; null if it cannot be read.
const ContentType* type_of_file(const std::string& path) {
  if (is_url_input(path)) return content_type_by_name(net::parse_url(path).path);
  const std::string local = local_input(path);
  const auto opened = net::map_file(local);
  const auto* const file = std::get_if<net::MappedFile>(&opened);
  return file ? &content_type_of(local, first_bytes(file->bytes())) : nullptr;
}

std::size_t written_nodes(const vrml::SceneGraph& scene) {
  std::size_t count = 0;
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const vrml::NodeId id = scene.nodes().id_at(i);
    count += scene.contains(id) && scene.node(id).instance == 0;
  }
  return count;
}

}  // namespace

bool exports_scene(const ConversionOptions& options, const std::string& in) {
  const bool wants_vectors = options.vectors > 0 || options.fraction > 0 || options.isovalue.has_value() ||
                             options.raw.dimensions != decltype(options.raw.dimensions){};
  if (wants_vectors) return false;
  const ContentType* const type = type_of_file(in);
  return type && (type->content == ContentClass::vrml || type->content == ContentClass::mesh);
}

int export_scene(const LoadingOptions& options, const std::string& in, const std::string& out,
                 const SceneFormat& format) {
  const auto start = std::chrono::steady_clock::now();
  LoadOptions load = load_options(options);
  const ContentType* const type = type_of_file(in);
  load.references = type && type->content == ContentClass::mesh;  // textures in the file or beside it
  LoadedWorld world = load_world(in, load);
  print_diagnostics(world.diagnostics);
  if (!world.scene) return kFailed;
  const SceneText made = scene_text(world, format.grammar, out);
  const std::span<const std::byte> plain = std::as_bytes(std::span(made.text));
  const std::vector<std::byte> packed = is_packed_path(out) ? gzip(plain) : std::vector<std::byte>();
  const std::span<const std::byte> bytes = is_packed_path(out) ? packed : plain;
  if (const auto refusal = refuse_to_replace(out, in, bytes)) return fail(*refusal);
  if (const auto problem = net::write_file_atomically(out, bytes)) return fail_to_write(problem->message);
  print_losses(in, made.losses);
  print_conversion({in, world.bytes, out, bytes.size(),
                    std::string(format.name) + ", " + counted(written_nodes(*world.scene), "node", "nodes")},
                   start);
  return world.truncated ? kFailed : kDone;
}

}  // namespace gs::app
