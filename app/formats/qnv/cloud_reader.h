#pragma once

#include "app/base/load_limit.h"
#include "app/formats/content_types.h"
#include "app/formats/volume/volume.h"
#include "base/budget.h"
#include "base/diagnostic.h"
#include "base/parallel.h"
#include "qnv/base/geometry.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/sampling/volume/volume.h"
#include "vrml/scene/field_value.h"
#include "vrml/scene/scene_graph.h"

#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>

namespace gs::app {

/// File to read as vectors.
struct CloudFile {
  std::string path;                  // for diagnostics, and to open a volume or a large stream
  std::span<const std::byte> bytes;  // the file, gzip-compressed or not
  bool cut = false;                  // intentionally truncated (`--max-bytes`)
  double loss = 0;                   // fraction of a stream's packets to drop (`--loss`)
  std::uint64_t loss_seed = 1;
  VolumeOrigin origin{};  // origin of a volume
  bool to_draw = false;   // keep a displaced surface as patches, which views refine, instead of arrays
};

/// Reads the vectors of a file of a type that `is_cloud`: from a stream, an importer, or the strongest 9 % of a
/// volume's gradients. Reports problems to `diagnostics`; returns nullopt if there is no vector to show. A truncated
/// stream gives fewer vectors, with a warning at most. Of a large complete packed stream, reads only header and
/// directory; it stays open, and views read the parts that they show. Safe for untrusted files; stops at `limit`.
/// Working memory is charged to `budget`; the caller charges the result (`hold_geometry`).
[[nodiscard]] std::optional<qnv::Geometry> read_geometry(const ContentType& type, const CloudFile& file,
                                                         Diagnostics& diagnostics, const LoadLimit& limit,
                                                         const WorldBudget& budget = own_budget());

/// Reports whether the budget has room for a copy of `geometry`.
[[nodiscard]] bool has_room_for(const qnv::Geometry& geometry, const Budget& budget);
/// Wraps decoded geometry with the budget share for it and the renderer's copy. Returns null if the budget is exceeded.
[[nodiscard]] std::shared_ptr<const qnv::Geometry> hold_geometry(qnv::Geometry geometry, const WorldBudget& budget);

/// Returns how many volume gradients the remaining budget allows.
[[nodiscard]] std::uint64_t most_gradients(const Budget& budget);

/// Memory in bytes per vector for decoding and display of a records stream.
inline constexpr std::uint64_t kDecodedBytes = 128;
/// Returns the max number of vectors of a stream to decode at once.
[[nodiscard]] std::size_t most_decoded_vectors(const Budget& budget);
/// Wraps a packed stream with the budget share for its cuts, cache and chunks, and limits them to that share. `grows`
/// means that received chunks are kept.
[[nodiscard]] std::shared_ptr<qnv::LodStream> hold_levels(std::unique_ptr<qnv::LodStream> stream,
                                                          const WorldBudget& budget, bool grows);

/// Opens a stream file for reading by any number of threads. Returns null if it cannot be opened.
[[nodiscard]] std::shared_ptr<const qnv::ChunkSource> stream_source(const std::string& path);

/// Builds the scene for a QNV geometry: a WorldInfo with its title, and a Shape with a QNV node with url `url`. Returns
/// the QNV node; null if the node limit is reached.
vrml::NodeId add_geometry_shape(vrml::SceneGraph& scene, const qnv::Geometry& geometry, const std::string& url);

/// Parses the `transfer` field of a QNV node: five numbers per point (value, red, green, blue, opacity), clamped to
/// 0..1 and sorted by value. Ignores an incomplete last point.
[[nodiscard]] std::vector<qnv::TransferPoint> transfer_of(const vrml::MFFloat& numbers);

/// Reads the inline vectors of a QNV node: 8-byte records (qnv/FORMAT-records.md) in its `vectors` field, two SFInt32
/// each, low word first, relative to its bounding box. For SURFACE profiles, weight 1 is 1/32767 of the area of the
/// box's largest side; for VOLUME, it is 1/32767. C is the class, which selects a surface's colour in `transfer` if
/// given. Returns a message if there are no vectors.
[[nodiscard]] std::variant<qnv::Geometry, std::string> inline_vectors(const vrml::SceneGraph& scene, vrml::NodeId qnv);

/// Timer for a piece of work: sets `progress.cancelled` when the limit is reached.
class Deadline {
 public:
  explicit Deadline(const LoadLimit& limit);
  ~Deadline();
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;
  Progress progress;

 private:
  std::mutex mutex_;
  std::condition_variable_any done_;
  std::jthread thread_;  // last member, so that it joins first
};

}  // namespace gs::app
