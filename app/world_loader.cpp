#include "app/world_loader.h"

#include "app/references.h"
#include "app/scene_reader.h"
#include "net/file.h"
#include "net/url.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

using Clock = std::chrono::steady_clock;
using vrml::Severity;

std::string title_of(const vrml::SceneGraph& scene, const std::string& path) {
  for (std::uint32_t i = 1; i <= scene.node_count(); ++i) {
    const vrml::NodeId id = scene.id_at(i);
    const vrml::Node& node = scene.node(id);
    if (node.in_prototype_body || node.type->name != "WorldInfo" || node.type->kind != vrml::NodeType::Kind::built_in)
      continue;
    const std::string title = scene.get<vrml::SFString>(id, "title").str();
    if (!title.empty()) return title;
  }
  return std::filesystem::path(path).filename().string();
}

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

OpenedWorld load_world(const std::string& asked, const LoadOptions& options) {
  const Clock::time_point start = Clock::now();
  const LoadLimit limit(start + std::chrono::duration_cast<Clock::duration>(
                                    std::chrono::duration<double>(std::min(options.timeout_seconds, 1e6))),
                        options.cancelled);
  OpenedWorld world;
  world.path = asked;
  world.title = std::filesystem::path(asked).filename().string();
  const net::Url url = net::parse_url(asked);
  if (!url.scheme.empty() && url.scheme != "file") {
    world.diagnostics.add(
        {Severity::error, asked, {}, "cannot load '" + url.scheme + ":' URLs; expected a path or a file: URL"});
    return world;
  }
  const std::string path = url.scheme == "file" ? net::path_of_url(url) : asked;
  auto opened = net::map_file(path);
  if (auto* problem = std::get_if<net::FileError>(&opened)) {
    world.diagnostics.add({Severity::error, asked, {}, problem->message});
    return world;
  }
  const net::MappedFile& file = std::get<net::MappedFile>(opened);
  const bool cut = file.bytes().size() > options.max_bytes;
  const std::span<const std::byte> bytes = file.bytes().subspan(0, std::min(file.bytes().size(), options.max_bytes));
  world.bytes = bytes.size();

  SceneRead read = read_scene(path, bytes, world.diagnostics, limit, {cut, options.loss, options.loss_seed});
  world.parse_seconds = seconds_since(start);
  world.truncated = !read.whole && !cut;
  if (!read.scene) return world;
  world.title = title_of(*read.scene, path);
  world.clouds = std::move(read.clouds);
  if (options.references) load_references(*read.scene, path, {world.images, world.clouds}, world.diagnostics, limit);
  world.scene = std::move(read.scene);
  return world;
}

}  // namespace gs::app
