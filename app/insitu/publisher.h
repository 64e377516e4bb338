#pragma once

#include "app/insitu/bricks/brick_shelf.h"
#include "app/insitu/parameters.h"
#include "app/insitu/step_streams.h"
#include "base/noncopyable.h"
#include "net/files/temporary_folder.h"
#include "net/serve/http_server.h"

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app::insitu {

/// Names of the world that shows the newest step, and of the JSON resource that describes the session.
inline constexpr const char* kLiveWorld = "live.wrl";
inline constexpr const char* kLiveJson = "insitu.json";

struct PublisherOptions {
  std::string folder;  // for all streams; if empty, a temporary folder keeps the newest streams
  bool serve = false;
  std::uint16_t port = 0;
  std::string bind, token_file, live_file, title;
  BrickShelf::Share share;  // of the server's thread; the functions must outlive the publisher
};

/// Output of a session on rank 0: streams in a folder, a world that shows the newest streams, and a server. Used by the
/// server's thread and one other thread.
class Publisher : NonCopyable {
 public:
  /// Starts the output. `parameters` must outlive the result. Returns the problem on failure.
  [[nodiscard]] static std::variant<std::unique_ptr<Publisher>, std::string> start(PublisherOptions options,
                                                                                   Parameters& parameters);
  ~Publisher();

  /// Writes the streams of a step, and makes them the newest. Returns nullopt on success, else the problem.
  [[nodiscard]] std::optional<std::string> publish(std::int64_t step, double time, std::vector<StepStream> streams);
  /// Reports whether the next step is needed: for the user's folder, for a waiting viewer, or as the first step.
  [[nodiscard]] bool is_wanted() const;
  /// Reports whether a viewer sent a request recently.
  [[nodiscard]] bool has_viewer() const;
  /// Returns chunks of kept grids that viewers wait for.
  [[nodiscard]] std::vector<WantedChunk> take_wanted(std::size_t most) { return shelf_.take_wanted(most); }
  /// Receives a chunk that take_wanted() returned.
  void deliver(const WantedChunk& wanted, std::vector<float> values);
  /// Drops the older of the two kept steps, to make room for the next one.
  void drop_older() { shelf_.drop_older(); }
  [[nodiscard]] std::uint16_t port() const { return server_ ? server_->port() : 0; }
  /// Returns the file with the token; empty if there is none.
  [[nodiscard]] const std::string& token_file() const { return token_file_; }

 private:
  Publisher(PublisherOptions options, Parameters& parameters)
      : options_(std::move(options)), parameters_(parameters), shelf_(options_.share) {}
  [[nodiscard]] std::optional<std::string> start_server();
  [[nodiscard]] std::optional<std::string> write_token(std::uint16_t port);
  [[nodiscard]] std::optional<std::string> write_address(std::uint16_t port);
  [[nodiscard]] std::string json() const;
  [[nodiscard]] net::PostAnswer post(const net::PostRequest& request);
  void note_viewer();
  void charge() const {
    if (options_.share.charge) options_.share.charge(0, 0);
  }
  void note_file(std::string_view name);

  const PublisherOptions options_;
  Parameters& parameters_;
  BrickShelf shelf_;
  net::LockedFolder temporary_;
  std::string folder_;  // with a slash at the end
  std::string token_, token_file_;
  bool has_live_file_ = false;

  mutable std::mutex mutex_;  // guards the members up to `kept_`
  std::string world_;
  bool shelved_ = false;  // the newest step has a grid on the shelf
  JsonValue about_;
  struct Kept {
    std::vector<std::string> files;
    std::uint64_t bytes = 0;
  };
  std::deque<Kept> kept_;  // steps in the temporary folder, newest last
  void drop_old();
  bool make_room();
  void remove_files(const Kept& kept) const;

  std::atomic<std::int64_t> viewer_{INT64_MIN};  // time of the last request of a viewer, nanoseconds
  std::atomic<bool> seen_{true};                 // a viewer requested the newest step or changed parameters
  std::unique_ptr<net::HttpServer> server_;      // last member, because its thread uses the others
};

/// Returns a VRML97 world that shows the streams in the given files.
[[nodiscard]] std::string world_of_streams(const std::string& title, std::int64_t step, double time,
                                           const std::vector<StepStream>& streams,
                                           const std::vector<std::string>& files);
/// Returns the name of the file of a field's stream, such as "heat.000120.qnv". It is none of `taken`: fields of points
/// and of cells may have one name, and names may differ in characters that files do not have.
[[nodiscard]] std::string stream_file_name(const StepStream& stream, std::int64_t step,
                                           const std::vector<std::string>& taken = {});

}  // namespace gs::app::insitu
