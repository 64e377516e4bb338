#pragma once

#include "app/formats/qnv/geometry_reader.h"
#include "app/formats/volume/overview_cache.h"
#include "app/loading/resources/resource_handler.h"
#include "app/streams/show_pace.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::qnv {
class StreamDecoder;
struct StreamHeader;
struct StreamProblem;
}  // namespace gs::qnv

namespace gs::app {

class PartialFile;

/// Content handler that decodes QNV streams and volumes, and splat files of other programs, while their bytes are
/// received.
class GeometryHandler final : public ResourceHandler {
 public:
  /// Callback that receives each better version of the vectors.
  using Show = std::function<void(const std::shared_ptr<const qnv::Geometry>&)>;
  using Progress = std::function<void(double)>;
  /// Callback that receives the vectors of a volume as a mesh (VoxelComponent::flow).
  using ShowMesh = std::function<void(MeshAsset)>;
  /// Creates a handler. A `request` without content means that the file is the world itself.
  GeometryHandler(Loading& loading, UrlRequest request, Show show, Progress progress = {});
  ~GeometryHandler() override;
  /// Lets the handler write the datasets of the file to VoxelComponent::found. Otherwise it may belong to another file.
  void note_datasets() { notes_datasets_ = true; }
  /// Lets the handler show the vectors of a volume as arrows or streamlines.
  void show_flow_by(ShowMesh show) { show_mesh_ = std::move(show); }
  /// Sets the function that returns the position of the vectors in the scene. The handler calls it after showing the
  /// first version. Later versions of streamed SOG go to that position, even after the end of this handler.
  void show_later_at(std::function<ResourceUpdates::Place()> place) { place_ = std::move(place); }
  void tell_progress(double fraction) override {
    if (progress_) progress_(fraction);
  }
  bool whole_file(const net::MappedFile& file, const std::string& path) override;
  void receive(std::span<const std::byte> bytes) override;
  void end(const std::optional<std::string>& problem) override;
  void receive_piece(const net::CellEvent& event) override;
  [[nodiscard]] bool has_more() const override { return array_ || !versions_.empty(); }
  void read_more() override;
  bool take_parts(const PartsOffer& offer) override;
  /// Reads a volume by parts. `front` has the first bytes of `file`.
  void read_parts(const std::shared_ptr<PartialFile>& file, std::span<const std::byte> front);
  /// Returns true if parts of the file could not be received or kept.
  [[nodiscard]] bool lacks_parts() const;
  std::shared_ptr<StreamFeed> feed() override { return way_ == Way::done ? nullptr : feed_; }

 private:
  enum class Way : std::uint8_t { unknown, pushed, decoded, whole, done };
  void choose_way();
  void start_levels(std::shared_ptr<qnv::LodStream> stream);
  void start_cuts(std::shared_ptr<qnv::SplatStream> stream);
  void start_bricks(const std::shared_ptr<qnv::BrickVolume>& volume);
  void start_decoder(const qnv::StreamHeader& header);
  void end_requests();
  void add_feed(std::shared_ptr<StreamFeed> feed);
  void show_records(bool last);
  void show_more();
  void read_bytes();
  void read_whole(std::span<const std::byte> bytes, const std::string& path);
  /// Shows streamed SOG, and lets views read its levels. Returns false if the handler must read it as a whole.
  bool start_splat_levels(const ContentType& type, std::span<const std::byte> bytes);
  /// Opens a volume and shows its coarsest version.
  void read_volume(const ContentType& type, const GeometryFile& file);
  /// Shows the vectors of a volume as a mesh. Returns false if no mesh was requested, or on failure.
  bool show_flow(const qnv::VolumeSource& source, const VoxelComponent& choice);
  /// Reports whether a volume has too many voxels for a single read.
  [[nodiscard]] bool is_large(const qnv::VolumeSource& source) const;
  /// Shows a volume in bricks that views read. Returns false if it is shown as a whole.
  bool start_array(qnv::VolumeSource& source);
  [[nodiscard]] OverviewCache overviews() const;
  /// Reads more of the overview of such a volume and shows it.
  void read_array();
  /// Shows the next version of a volume. Returns false if it has nothing to show.
  bool show_next_version();
  /// Warns once of parts of the file that could not be received or read.
  void warn_of_trouble();
  void report_problems(const std::vector<qnv::StreamProblem>& problems, Severity severity);
  /// Stops reading after a part exceeded the memory budget. That part is omitted.
  void give_up(Resource resource);
  bool count_decoded();
  [[nodiscard]] bool is_node() const { return request_.content != vrml::UrlContent::none; }

  Show show_;
  bool notes_datasets_ = false;
  ShowMesh show_mesh_;                             // null if vectors are shown as volumes only
  std::function<ResourceUpdates::Place()> place_;  // null if no versions follow the end
  Progress progress_;
  Way way_ = Way::unknown;
  Share decoded_;
  std::shared_ptr<StreamFeed> feed_;
  std::unique_ptr<qnv::StreamDecoder> decoder_;
  std::size_t shown_ = 0;
  std::uint64_t shown_revision_ = 0;
  ShowPace pace_;
  bool shown_exact_ = false;  // the exact mesh in the tail of the stream is shown
  bool by_chunks_ = false;    // chunks were received in any order
  std::size_t damaged_chunks_ = 0;
  std::shared_ptr<qnv::ArrayVolume> array_;      // volume with an incomplete overview
  std::chrono::milliseconds array_patience_{0};  // wait for the next part of the overview
  std::shared_ptr<PartialFile> parts_;           // file of a server that is read by parts, or null
  std::string told_trouble_;
  std::string array_key_;                       // key of its overview in the cache; empty if not cached
  std::function<std::string()> array_trouble_;  // VolumeSource::trouble of that volume
  std::deque<qnv::VolumeSource> versions_;      // later versions of a volume, the coarsest first
};

}  // namespace gs::app
