#pragma once

#include "app/base/load_limit.h"
#include "app/formats/content_types.h"
#include "app/formats/volume/volume.h"
#include "base/budget.h"
#include "base/diagnostic.h"
#include "base/parallel.h"
#include "qnv/base/geometry.h"
#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/codecs/values/arrays/array_volume.h"
#include "qnv/codecs/values/bricks/brick_series.h"
#include "qnv/codecs/values/bricks/brick_volume.h"
#include "qnv/sampling/volume/volume.h"
#include "vrml/scene/scene_graph.h"
#include "vrml/scene/values/field_value.h"

#include <chrono>
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
struct GeometryFile {
  std::string path;                  // name for diagnostics; also opens volumes and large streams
  std::span<const std::byte> bytes;  // bytes of the file, gzip-compressed or not
  bool cut = false;                  // truncated on purpose (`--max-bytes`)
  double loss = 0;                   // fraction of a stream's packets to drop (`--loss`), 0 to 1
  std::uint64_t loss_seed = 1;
  VolumeOrigin origin{};  // origin of a volume's files
  bool local = false;     // a file of this machine
  bool to_draw = false;   // true keeps a displaced surface as patches for cuts, not as arrays
};

/// Reads the vectors of a file of a type that `is_geometry`: from a stream, an importer, or the strongest 9 % of a
/// volume's gradients. Reports problems to `diagnostics`; returns nullopt if there is no vector to show. A truncated
/// stream gives fewer vectors, with a warning at most. Of a large complete packed stream, reads only header and
/// directory; it stays open, and views read the parts that they show. Safe for untrusted files; stops at `limit`.
/// Working memory is charged to `budget`; the caller charges the result (`hold_geometry`).
[[nodiscard]] std::optional<qnv::Geometry> read_geometry(const ContentType& type, const GeometryFile& file,
                                                         Diagnostics& diagnostics, const LoadLimit& limit,
                                                         const WorldBudget& budget = own_budget());

/// Opens a volume for read_gradients(). Reports problems to `diagnostics`.
[[nodiscard]] std::optional<qnv::VolumeSource> open_volume_source(const ContentType& type, const GeometryFile& file,
                                                                  Diagnostics& diagnostics,
                                                                  const WorldBudget& budget = own_budget());
/// Reads the strongest gradients of a volume as vectors. Reports problems as those of `path`. If `keep_values`, the
/// result has the values, too, in memory: the source cannot be read later, because a server has it.
[[nodiscard]] std::optional<qnv::Geometry> read_gradients(const qnv::VolumeSource& source, const std::string& path,
                                                          bool keep_values, Diagnostics& diagnostics,
                                                          const LoadLimit& limit,
                                                          const WorldBudget& budget = own_budget());

/// Reports whether the budget has room for a copy of `geometry`.
[[nodiscard]] bool has_room_for(const qnv::Geometry& geometry, const Budget& budget);
/// Charges `budget` for a geometry and the renderer's copy of it. The result owns the geometry and its share. Returns
/// null if the budget is exceeded.
[[nodiscard]] std::shared_ptr<const qnv::Geometry> hold_geometry(qnv::Geometry geometry, const WorldBudget& budget);

/// Returns the number of volume gradients for which the remaining budget suffices.
[[nodiscard]] std::uint64_t most_gradients(const Budget& budget);

/// Bytes per vector for decoding and showing a records stream.
inline constexpr std::uint64_t kDecodedBytes = 128;
/// Returns the maximum number of vectors to decode from a stream at once.
[[nodiscard]] std::size_t most_decoded_vectors(const Budget& budget);

/// Charges `budget` for the bricks and received chunks of a volume that is larger than memory. The result owns the
/// share.
struct BrickShare {
  /// Bricks get one of `parts` equal parts of the remaining memory for vectors.
  BrickShare(const WorldBudget& budget, bool grows, std::uint64_t parts = 8);
  Share bricks, arrived;
  qnv::BrickLimits limits;
};
/// Returns the volume, which keeps its share.
[[nodiscard]] std::shared_ptr<qnv::BrickVolume> hold_bricks(std::shared_ptr<qnv::BrickVolume> volume, BrickShare share);
/// Returns a volume with the vectors that its bricks have now, and requests of views for more.
[[nodiscard]] qnv::Volume volume_of(const std::shared_ptr<qnv::BrickVolume>& bricks);

/// Prepares a volume in a file for views that read its bricks. Charges `budget` for them; the result owns the share.
/// Pictures without a window wait at most `patience` for bricks. Returns null if the volume cannot be shown in bricks.
[[nodiscard]] std::shared_ptr<qnv::ArrayVolume> hold_array(
    qnv::VolumeSource source, const WorldBudget& budget,
    std::chrono::milliseconds patience = qnv::ArrayVolume::kPatience);
/// Returns a volume with the vectors of the overview, as far as it was read, and finer ones for views.
[[nodiscard]] qnv::Volume volume_of(const std::shared_ptr<qnv::ArrayVolume>& array);

/// Opens a stream file for reading. The result may be used by any number of threads. Returns null if the file cannot be
/// opened.
[[nodiscard]] std::shared_ptr<const qnv::ChunkSource> stream_source(const std::string& path);

/// Adds a WorldInfo with a title, and a Shape with a QNV node that has this url. Returns the QNV node, or null at the
/// node limit.
vrml::NodeId add_geometry_shape(vrml::SceneGraph& scene, const qnv::Geometry& geometry, const std::string& url);

/// Parses the `transfer` field of a QNV node. Each point is five numbers: value, red, green, blue, opacity. Clamps them
/// to 0..1 and sorts the points by value. Ignores an incomplete last point.
[[nodiscard]] std::vector<qnv::TransferPoint> transfer_of(const vrml::MFFloat& numbers);

/// Reads the inline vectors of a QNV node: 8-byte records (qnv/FORMAT-records.md) in its `vectors` field. Two SFInt32
/// make a record, low word first, relative to the bounding box of the node. For SURFACE profiles, weight 1 is 1/32767
/// of the area of the box's largest side. For VOLUME profiles, weight 1 is 1/32767. C is the class; for a surface, it
/// selects the colour in `transfer`, if given. Returns a message if there are no vectors.
[[nodiscard]] std::variant<qnv::Geometry, std::string> inline_vectors(const vrml::SceneGraph& scene, vrml::NodeId qnv);

/// Timer that sets `progress.cancelled` when `limit` is reached.
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
  std::jthread thread_;  // last member, so that the thread ends before the others are destroyed
};

}  // namespace gs::app
