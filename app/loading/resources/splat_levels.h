#pragma once

#include "app/base/read_files.h"
#include "app/formats/content_types.h"
#include "app/formats/splats/sog_levels.h"
#include "app/loading/fetch/loading.h"
#include "app/streams/show_pace.h"
#include "app/streams/stream_feed.h"
#include "app/streams/viewed_transfer.h"
#include "base/budget.h"
#include "net/base/reference_policy.h"
#include "qnv/base/geometry.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Reader of streamed SOG for views: first the coarsest level of all parts, then finer levels of the parts in view, the
/// widest gaps between splats first. Requests the files of a few SOGs at a time. Cancels requests that no view needs
/// any more. Keeps the splats of the coarsest and of the wanted levels. Reader thread only.
class SplatLevels final : public ViewedTransfer {
 public:
  struct Source {
    SogLevels levels;
    const ContentType* type = nullptr;  // streamed SOG
    std::string path;                   // of lod-meta.json, in messages
    net::Origin origin;                 // of lod-meta.json
    bool local = false;
    bool shows_between = false;  // also reads levels between the coarsest and the wanted ones
  };
  SplatLevels(Loading& loading, Source source);
  ~SplatLevels() override;

  /// Reads a part of the coarsest level and returns its splats. Blocks. Returns null if no file can be read; reports
  /// the reason.
  [[nodiscard]] std::shared_ptr<const qnv::Geometry> read_first();
  /// Returns the feed that receives the views.
  [[nodiscard]] const std::shared_ptr<StreamFeed>& feed() const { return feed_; }
  /// Sets the receiver of better versions.
  void show_by(std::function<void(std::shared_ptr<const qnv::Geometry>)> show) { show_ = std::move(show); }

  bool ask_for_more() override;
  bool take(net::LoadEvent& event) override;
  void cancel() override;
  void cancel_row(std::uint64_t row) override;
  [[nodiscard]] bool over() const override { return over_; }
  [[nodiscard]] bool rests() const override { return chosen_ && wanted_.empty() && jobs_.empty() && !changed_; }

  /// Returns the number of splats of the last version; for tests.
  [[nodiscard]] std::size_t shown_splats() const { return shown_splats_; }

 private:
  /// Indices of leaf and run. A leaf index equal to the number of leaves means the environment.
  using Key = std::pair<std::uint32_t, std::uint8_t>;
  /// Splats of a run.
  struct Piece {
    qnv::Gaussians splats;
    Share share;
  };
  /// Bytes of the files of a SOG, by their paths.
  using Files = std::map<std::string, SharedBytes>;
  /// File with runs to read.
  struct Wanted {
    std::uint32_t file = 0;
    std::set<Key> keys;
  };
  /// SOG that is being received.
  struct Job {
    struct File {
      net::RequestId id;
      std::string path;
      std::vector<std::byte> bytes;
      bool done = false;
    };
    std::uint32_t file = 0;
    std::vector<File> files;  // meta.json first
    Share share;
    std::uint64_t row = 0;  // of the ledger
    int priority = 0;
  };

  [[nodiscard]] const std::string& path_of(std::uint32_t file) const;
  [[nodiscard]] SogRun run_of(const Key& key) const;
  [[nodiscard]] std::uint64_t held_splats() const;
  void choose();
  [[nodiscard]] bool is_between(const SogStep& step) const;
  void add_wanted(std::uint32_t leaf, std::uint8_t run);
  void drop_unwanted();
  bool start_jobs();
  void request(Job& job, const std::string& path);
  void finish_job(std::size_t index);
  void end_job(std::size_t index, bool received);
  void read_now(std::uint32_t file);
  /// Decodes the wanted runs of a SOG. Returns a message on failure.
  std::optional<std::string> decode(std::uint32_t file, const Files& files);
  void keep_files(std::uint32_t file, Files files);
  void fail(std::uint32_t file, const std::string& why);
  [[nodiscard]] SogChoice shown_choice() const;
  [[nodiscard]] std::shared_ptr<const qnv::Geometry> compose();
  void show_if_due();

  Loading& loading_;
  const Source source_;
  const std::uint64_t most_;  // maximum splats
  std::shared_ptr<StreamFeed> feed_;
  std::function<void(std::shared_ptr<const qnv::Geometry>)> show_;
  std::vector<qnv::LodView> views_;
  std::vector<bool> unreadable_;  // per file; the last one is the environment
  std::size_t failures_ = 0;
  SogChoice base_, target_;
  std::vector<Wanted> wanted_;                  // most wanted first
  std::vector<std::optional<std::size_t>> at_;  // index in `wanted_` by file, while choose() makes the list
  std::vector<Job> jobs_;
  std::map<Key, Piece> pieces_;
  std::map<std::uint32_t, std::pair<Files, std::uint64_t>> files_;  // recent files, with the time of their last use
  std::uint64_t uses_ = 0;
  glm::dvec3 origin_{0};  // of all versions
  bool has_origin_ = false, chosen_ = false, changed_ = false, over_ = false;
  std::size_t shown_splats_ = 0;
  ShowPace pace_;
};

}  // namespace gs::app
