#pragma once

#include "app/base/load_limit.h"
#include "app/base/world_budget.h"
#include "app/formats/content_types.h"
#include "app/formats/volume/volume.h"
#include "qnv/base/cloud.h"
#include "qnv/base/parallel.h"
#include "qnv/lod/lod.h"
#include "qnv/lod/lod_source.h"
#include "qnv/volume/volume.h"
#include "vrml/scene/diagnostic.h"
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

/// A file that becomes vectors.
struct CloudFile {
  std::string path;                  // for diagnostics, and where a volume or a large stream is opened
  std::span<const std::byte> bytes;  // of the file, gzip'd or not
  bool cut = false;                  // more bytes would follow, and nobody misses them (`--max-bytes`)
  double loss = 0;                   // this share of a stream's packets never comes (`--loss`)
  std::uint64_t loss_seed = 1;
  VolumeOrigin origin{};  // of a volume
  bool to_draw = false;   // a displaced surface becomes patches, of which views take cuts, and no arrays
};

/// The vectors of a file of a type that `is_cloud`: a stream's, an importer's, or the strongest 9 % of a
/// volume's gradients. What is wrong goes to `diagnostics`; nothing when there is no vector to show. A stream that
/// ends early is a smaller cloud and gives a warning at most. Of a large packed stream that is whole only the header
/// and the directory are read now: it stays open, and views read what they show. Safe for untrusted files; gives up at
/// `limit`. Memory for the work is drawn from `budget`; that of the result is the caller's to draw (`hold_cloud`).
[[nodiscard]] std::optional<qnv::Cloud> read_cloud(const ContentType& type, const CloudFile& file,
                                                   vrml::Diagnostics& diagnostics, const LoadLimit& limit,
                                                   const WorldBudget& budget = own_budget());

/// Whether there is enough left of a budget to hold a copy of a cloud.
[[nodiscard]] bool has_room_for(const qnv::Cloud& cloud, const vrml::Budget& budget);
/// A cloud with the part of the budget that it takes, with the copy of who draws it; null where there is not so much.
[[nodiscard]] std::shared_ptr<const qnv::Cloud> hold_cloud(qnv::Cloud cloud, const WorldBudget& budget);

/// How many gradients of a volume may be found.
[[nodiscard]] std::uint64_t most_gradients(const vrml::Budget& budget);

/// What a vector takes while a stream of records is decoded and shown.
inline constexpr std::uint64_t kDecodedBytes = 128;
/// How many vectors of a stream may be decoded at once.
[[nodiscard]] std::size_t most_decoded_vectors(const vrml::Budget& budget);
/// A packed stream with the part of the budget that its cuts, its cache and its chunks may take, which are limited to
/// that. `grows`: its chunks are kept as they come.
[[nodiscard]] std::shared_ptr<qnv::LodStream> hold_levels(std::unique_ptr<qnv::LodStream> stream,
                                                          const WorldBudget& budget, bool grows);

/// A stream that lies in a file, which stays open; null where it cannot be opened. Any number of threads may read it.
[[nodiscard]] std::shared_ptr<const qnv::ChunkSource> stream_source(const std::string& path);

/// Makes the scene that shows a cloud: a WorldInfo with its title, and a Shape with a QNV node whose url is
/// `url`. The QNV node; null when the scene may have no more nodes.
vrml::NodeId add_cloud_shape(vrml::SceneGraph& scene, const qnv::Cloud& cloud, const std::string& url);

/// The points of the `transfer` field of a QNV node: five numbers each (value, red, green, blue, opacity), clamped
/// to 0..1 and sorted by value. Numbers that are missing at the end are ignored.
[[nodiscard]] std::vector<qnv::TransferPoint> transfer_of(const vrml::MFFloat& numbers);

/// Returns the vectors in the `vectors` field of a QNV node: 8-byte records (qnv/FORMAT.md, "Records payload"), two
/// SFInt32 each, low word first, relative to the node's bounding box. If `profile` is SURFACE, a weight of 1 means
/// 1/32767 of the area of the box's largest side; if VOLUME, it means 1/32767. C is the class. For a surface,
/// `transfer`, if given, maps it to a colour. Returns a message if there are no valid vectors.
[[nodiscard]] std::variant<qnv::Cloud, std::string> inline_cloud(const vrml::SceneGraph& scene, vrml::NodeId qnv);

/// A piece of work that ends at a limit: sets `cancelled` then.
class Deadline {
 public:
  explicit Deadline(const LoadLimit& limit);
  ~Deadline();
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;
  qnv::Progress progress;

 private:
  std::mutex mutex_;
  std::condition_variable_any done_;
  std::jthread thread_;  // last: joined before what it uses goes
};

}  // namespace gs::app
