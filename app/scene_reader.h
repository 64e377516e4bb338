#pragma once

#include "app/load_limit.h"
#include "render/render_list.h"
#include "vrml/diagnostic.h"
#include "vrml/scene_graph.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace gs::app {

/// What of a file comes.
struct Arrival {
  bool cut = false;  // it has more bytes than are given, and nobody misses them (`--max-bytes`)
  double loss = 0;   // of a stream, this share of its packets never comes (`--loss`)
  std::uint64_t loss_seed = 1;
};

/// What the bytes of one file became.
struct SceneRead {
  std::unique_ptr<vrml::SceneGraph> scene;  // null: nothing to show; the diagnostics say why
  bool whole = true;                        // false: the bytes end before the scene does
  render::Clouds clouds;                    // of a file of vectors: what its QNV node shows
};

/// Makes a scene of the bytes of a file of any type of the table of content types, gzip'd or not; nothing
/// that it refers to is read but the materials and buffers that belong to the format. Stops at `limit`.
/// `arrival`: what of the bytes comes. Safe for untrusted bytes.
[[nodiscard]] SceneRead read_scene(const std::string& path, std::span<const std::byte> bytes,
                                   vrml::Diagnostics& diagnostics, const LoadLimit& limit, const Arrival& arrival = {});

}  // namespace gs::app
