#pragma once

#include "app/formats/qnv/cloud_reader.h"
#include "app/world/world_loading_state.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::qnv {
class StreamDecoder;
struct StreamProblem;
}  // namespace gs::qnv

namespace gs::app {

/// Content handler that decodes QNV streams, volumes and splat files of other programs as their bytes are received.
class CloudHandler final : public ContentHandler {
 public:
  using World = WorldLoading::State;
  /// Called with each better version of the vectors.
  using Show = std::function<void(const std::shared_ptr<const qnv::Geometry>&)>;
  using Progress = std::function<void(double)>;
  /// Owner of the vectors, for messages.
  struct Place {
    std::string file;
    SourceLocation location;
    vrml::MFString urls;
    bool is_node = false;  // a QNV node; otherwise the world itself
  };
  CloudHandler(World& world, Place place, Show show, Progress progress = {});
  ~CloudHandler() override;
  void tell_progress(double fraction) override {
    if (progress_) progress_(fraction);
  }
  bool begin(const Found& found) override;
  bool whole_file(const net::MappedFile& file, const std::string& path) override;
  void receive(std::span<const std::byte> bytes) override;
  void end(const std::optional<std::string>& problem) override;
  void missing(const std::string& why) override;
  bool seek(RangedStream::Place place) override;
  void receive_cells(const net::CellEvent& event) override;
  std::shared_ptr<StreamFeed> follow() override { return way_ == Way::pushed ? feed_ : nullptr; }

 private:
  enum class Way : std::uint8_t { unknown, pushed, decoded, whole, done };
  void choose_way();
  void start_feed(std::shared_ptr<qnv::LodStream> stream);
  void show_records(bool last);
  void read_bytes();
  void read_whole(std::span<const std::byte> bytes, const std::string& path);
  void report_problems(const std::vector<qnv::StreamProblem>& problems, Severity severity);
  /// Stops reading after the memory budget has refused a part, which is omitted.
  void give_up(Resource resource);
  bool count_decoded();

  World& world_;
  Place place_;
  Show show_;
  Progress progress_;
  Found found_;
  Way way_ = Way::unknown;
  std::vector<std::byte> bytes_;
  Share held_bytes_, decoded_;
  std::shared_ptr<StreamFeed> feed_;
  std::unique_ptr<qnv::StreamDecoder> decoder_;
  std::size_t shown_ = 0;
  std::uint64_t shown_revision_ = 0;
  bool shown_exact_ = false;     // the exact mesh of the tail is shown
  std::uint64_t directory_ = 0;  // offset of the directory of a packed stream; 0 means unknown
};

}  // namespace gs::app
