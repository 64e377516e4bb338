#pragma once

#include <catch2/catch.hpp>

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "base/noncopyable.h"
#include "net/load/load_engine.h"
#include "net/load/loader.h"
#include "tests/net/memory_network.h"

/// Helpers of tests of the loader.
namespace gs::net::test {

/// Temporary folder of one test.
class TemporaryFolder : NonCopyable {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "ghostspace-loader-test-XXXXXX").string();
    REQUIRE(::mkdtemp(name.data()) != nullptr);
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  [[nodiscard]] std::string operator/(std::string_view name) const { return (path_ / name).string(); }
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

inline std::vector<std::byte> bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text.data(), text.size()));
  return {bytes.begin(), bytes.end()};
}

/// Returns text in which any few consecutive bytes occur once.
inline std::string pattern(std::size_t size, unsigned version = 0) {
  std::string result;
  result.reserve(size + 16);
  for (std::size_t i = 0; result.size() < size; ++i)
    result += std::to_string(i) + static_cast<char>('a' + version % 26);
  result.resize(size);
  return result;
}

/// Returns a VRML file of this text for the memory transport.
inline MemoryResource resource(const std::string& text, const std::string& etag = "\"1\"") {
  MemoryResource result;
  result.bytes = bytes_of(text);
  result.content_type = "model/vrml";
  result.validator.etag = etag;
  return result;
}

/// Returns a request for these ranges of a resource.
inline Request ranges_of(const std::string& url, std::vector<ByteRange> ranges) {
  Request request;
  request.url = url;
  request.ranges = std::move(ranges);
  return request;
}

/// Result of one request. Fails the test if the order of events is wrong.
struct Outcome {
  std::string events;  // one letter per event: H head, d a run of data, R restart, . done, ! error
  LoadHead head;
  std::map<std::uint64_t, std::string> pieces;  // joined
  std::optional<LoadError> error;
  bool done = false, in_order = true;
  std::uint64_t received = 0;

  [[nodiscard]] bool ended() const { return done || error; }
  [[nodiscard]] std::string text() const {
    return pieces.empty()                                     ? std::string()
           : pieces.size() == 1 && pieces.begin()->first == 0 ? pieces.begin()->second
                                                              : "not one piece";
  }
  void add(const LoadEvent& event) {
    REQUIRE_FALSE(ended());
    if (const auto* const what = std::get_if<LoadHead>(&event.what)) {
      events += 'H';
      head = *what;
    } else if (const auto* const data = std::get_if<LoadData>(&event.what)) {
      add(*data);
    } else if (std::holds_alternative<LoadRestarted>(event.what)) {
      events += 'R';
      pieces.clear();
      received = 0;
    } else if (std::holds_alternative<LoadDone>(event.what)) {
      events += '.';
      done = true;
    } else {
      events += '!';
      error = std::get<LoadError>(event.what);
    }
  }

 private:
  void add(const LoadData& data) {
    REQUIRE_FALSE(data.bytes.empty());
    if (events.empty() || events.back() != 'd') events += 'd';
    std::string text(reinterpret_cast<const char*>(data.bytes.data()), data.bytes.size());
    received += text.size();
    auto after = pieces.upper_bound(data.offset);
    if (after != pieces.end()) {
      in_order = false;
      REQUIRE(after->first >= data.offset + text.size());
    }
    if (after != pieces.begin()) {
      const auto before = std::prev(after);
      REQUIRE(before->first + before->second.size() <= data.offset);  // no byte arrives twice
      if (before->first + before->second.size() == data.offset) {
        before->second += text;
        if (after != pieces.end() && after->first == data.offset + text.size()) {
          before->second += after->second;
          pieces.erase(after);
        }
        return;
      }
    }
    if (after != pieces.end() && after->first == data.offset + text.size()) {
      text += after->second;
      pieces.erase(after);
    }
    pieces[data.offset] = std::move(text);
  }
};

/// Engine with the memory transport and a simulated clock, without threads and waiting.
class Bench {
 public:
  explicit Bench(LoaderOptions given = {}, std::unique_ptr<HttpCache> cache = nullptr)
      : options(std::move(given)), cache_(std::move(cache)) {
    if (!options.random)
      options.random = [this] { return random_ = random_ * 6364136223846793005u + 1442695040888963407u; };
    if (!options.unix_seconds)
      options.unix_seconds = [this] {
        return unix_start + std::chrono::duration_cast<std::chrono::seconds>(now - TimePoint{}).count();
      };
    queue.emplace(options.max_queued_bytes, options.max_queued_bytes_per_request, options.wake);
    engine.emplace(options, *queue, cache_.get());
    engine->add_transport(TransportKind::memory, std::make_unique<MemoryTransport>(network));
    engine->add_transport(TransportKind::file, make_file_transport());
    engine->add_transport(TransportKind::data, make_data_transport());
  }

  RequestId request(Request request) {
    const RequestId id{++last_id_};
    queue->open(id, request.priority);
    engine->request(id, std::move(request));
    return id;
  }
  RequestId request(const std::string& url) {
    Request request;
    request.url = url;
    return this->request(std::move(request));
  }
  void cancel(RequestId id) {
    queue->close(id);
    engine->cancel(id);
  }
  void poll(std::size_t max_bytes = std::size_t{1} << 30) {
    for (const LoadEvent& event : queue->poll(max_bytes)) outcomes[event.id].add(event);
  }
  /// Runs until nothing more happens, or for a time.
  void run(Milliseconds time = Milliseconds(3'600'000), bool polls = true) {
    const TimePoint end = now + time;
    for (int i = 0; i < 1'000'000; ++i) {
      const auto next = engine->step(now);
      const std::size_t before = queue->queued_bytes();
      if (polls) poll();
      if (polls && before > 0) continue;  // polling freed space, so continue
      if (!next) return;
      if (*next > end) {
        now = end;
        return;
      }
      now = std::max(now, *next);
    }
    FAIL("the engine never comes to rest");
  }
  Outcome& load(const Request& what) {
    const RequestId id = request(what);
    run();
    return outcomes[id];
  }
  Outcome& load(const std::string& url) {
    Request what;
    what.url = url;
    return load(what);
  }

  LoaderOptions options;
  std::int64_t unix_start = 1'700'000'000;
  TimePoint now{};
  std::shared_ptr<MemoryNetwork> network = std::make_shared<MemoryNetwork>();
  std::map<RequestId, Outcome> outcomes;

 private:
  std::unique_ptr<HttpCache> cache_;
  std::uint64_t last_id_ = 0, random_ = 1;

 public:
  std::optional<LoadQueue> queue;
  std::optional<LoadEngine> engine;
};

/// Polls a loader with threads until all requests have ended.
inline std::map<RequestId, Outcome> wait_for(Loader& loader, const std::vector<RequestId>& ids,
                                             std::size_t max_bytes = std::size_t{1} << 30) {
  std::map<RequestId, Outcome> outcomes;
  const auto open = [&] {
    for (const RequestId id : ids)
      if (!outcomes[id].ended()) return true;
    return false;
  };
  // The deadline only prevents a hang; it checks no time.
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (open()) {
    for (const LoadEvent& event : loader.poll(max_bytes)) outcomes[event.id].add(event);
    REQUIRE(std::chrono::steady_clock::now() < deadline);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return outcomes;
}

inline Outcome load(Loader& loader, Request request) {
  const RequestId id = loader.request(std::move(request));
  return wait_for(loader, {id})[id];
}
inline Outcome load(Loader& loader, const std::string& url) {
  Request request;
  request.url = url;
  return load(loader, std::move(request));
}

}  // namespace gs::net::test
