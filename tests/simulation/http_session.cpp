#include "tests/simulation/http_session.h"

#include "net/http/http_cache.h"
#include "net/load/load_engine.h"
#include "net/load/load_queue.h"
#include "tests/simulation/http_network.h"
#include "tests/simulation/stream_viewer.h"

#include <algorithm>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <variant>

namespace gs::simulation {
namespace {

using net::Milliseconds;
using net::TimePoint;

constexpr std::int64_t kUnixStart = 1'700'000'000;
constexpr Milliseconds kLongestHttp{3'600'000};  // of a session
constexpr std::size_t kMostHttpSteps = 3'000'000;
// Failures that a session must survive.
constexpr Milliseconds kShortCut{10'000}, kShortRestart{3'000};

/// Plain load of a file or of ranges of it.
struct Load {
  const Content* content = nullptr;
  std::vector<net::ByteRange> ranges;
  TimePoint begin{};
  std::optional<TimePoint> cancel;
  int priority = 0;
  std::optional<net::RequestId> id;
  bool over = false;
};

/// Bytes that a request has received, compared with the files.
struct Received {
  const Content* content = nullptr;
  std::optional<std::uint64_t> total;
  std::vector<bool> seen;  // by offset
  std::uint64_t delivered = 0;
  std::vector<net::ByteRange> ranges;
  std::uint64_t next = 0;  // of a request of one range: the expected offset
  bool ended = false;
};

class HttpSession final : public net::LoadRequests {
 public:
  HttpSession(std::uint64_t seed, bool prints);
  ~HttpSession() = default;
  SessionResult run();

  net::RequestId request(net::Request request) override;
  void cancel(net::RequestId id) override;

 private:
  [[nodiscard]] std::int64_t microseconds() const {
    return std::chrono::duration_cast<std::chrono::microseconds>(now_.time_since_epoch()).count();
  }
  [[nodiscard]] std::int64_t unix_seconds() const {
    return kUnixStart + std::chrono::duration_cast<std::chrono::seconds>(now_.time_since_epoch()).count();
  }
  Weather plan_weather();
  void plan_clients();
  [[nodiscard]] std::uint64_t answers() const;
  [[nodiscard]] bool may_fail(const Content& content) const;
  void open_engine();
  void begin_due();
  void poll();
  void take(net::LoadEvent& event);
  void check(const net::LoadEvent& event);
  void check_stream(const StreamClient& stream);
  [[nodiscard]] bool over() const;
  [[nodiscard]] TimePoint next_event(std::optional<TimePoint> deadline) const;
  void restart_client();

  Random random_;
  Trace trace_;
  ServedFiles files_;
  TimePoint now_{std::chrono::seconds(1)};
  net::HttpServerOptions site_options_;
  std::optional<net::HttpSite> site_;
  net::LoaderOptions options_;
  Weather weather_;
  bool survivable_ = true;
  std::uint64_t answers_before_ = 0;  // of the server, when the program of the client began
  HttpCounts counts_;
  Random engine_random_;
  std::optional<net::LoadQueue> queue_;
  std::unique_ptr<net::HttpCache> cache_;
  std::unique_ptr<net::LoadEngine> engine_;
  std::uint64_t last_id_ = 0, network_seed_;
  std::map<std::uint64_t, Received> received_;
  std::vector<Load> loads_;
  std::vector<const Content*> watched_;
  std::vector<std::unique_ptr<StreamClient>> streams_;
  std::map<TimePoint, std::pair<const Content*, int>> uploads_;
  std::set<const Content*> changed_;
  std::set<const StreamClient*> ended_streams_;
  TimePoint next_poll_{}, next_draw_{};
  std::optional<TimePoint> client_restart_;
  std::uint64_t delivered_ = 0, failed_ = 0;
  std::size_t pictures_ = 0, restarts_ = 0;
};

HttpSession::HttpSession(std::uint64_t seed, bool prints)
    : random_(seed), trace_(prints), engine_random_(random_.next()), network_seed_(random_.next()) {
  for (const Content& content : contents()) files_.put(content, 0, kUnixStart - 1000);
  site_options_.folder = files_.folder();
  site_options_.host_names = {"site.example"};
  site_options_.max_age = random_.chance(0.3) ? 60 : 0;
  auto folder = net::ServedFolder::open(files_.folder());
  require(std::holds_alternative<net::ServedFolder>(folder), "the folder cannot be served");
  site_.emplace(site_options_, std::move(std::get<net::ServedFolder>(folder)), nullptr, nullptr);
  weather_ = plan_weather();
  if (random_.chance(0.6)) options_.cache_folder = files_.cache();
  options_.random = [this] { return engine_random_.next(); };
  options_.unix_seconds = [this] { return unix_seconds(); };
  if (random_.chance(0.3)) {
    options_.max_queued_bytes = 64 << 10;
    options_.max_queued_bytes_per_request = 32 << 10;
  }
  open_engine();
  plan_clients();
}

Weather HttpSession::plan_weather() {
  Weather weather;
  weather.round_trip = Milliseconds(random_.one_of(std::vector<int>{1, 20, 50, 200, 800}));
  weather.bytes_per_second = random_.one_of(std::vector<std::uint64_t>{8'000, 25'000, 125'000, 1'250'000, 12'500'000});
  if (random_.chance(0.5)) weather.lost = random_.between(0.0, 0.1);
  if (random_.chance(0.3)) weather.broken = random_.between(0.0, 0.02);
  if (random_.chance(0.3)) weather.busy = random_.between(0.0, 0.05);
  const auto periods = [this](Milliseconds at_most) {
    std::vector<Period> all;
    TimePoint at = now_;
    for (std::uint64_t count = random_.between(std::uint64_t{0}, 3); count > 0; --count) {
      at += Milliseconds(random_.between(std::uint64_t{100}, 20'000));
      const TimePoint begin = at;
      at += Milliseconds(random_.between(std::uint64_t{50}, static_cast<std::uint64_t>(at_most.count())));
      all.push_back({begin, at});
    }
    return all;
  };
  survivable_ = random_.chance(0.7);
  if (random_.chance(0.5)) weather.cuts = periods(survivable_ ? kShortCut : 6 * kShortCut);
  if (random_.chance(0.4)) weather.restarts = periods(survivable_ ? kShortRestart : 20 * kShortRestart);
  return weather;
}

void HttpSession::plan_clients() {
  const auto soon = [this](std::uint64_t most) { return now_ + Milliseconds(random_.between(std::uint64_t{0}, most)); };
  for (const Content& content : contents())
    if (content.name.ends_with(".qnv") && random_.chance(0.5)) watched_.push_back(&content);
  const std::uint64_t loads = random_.between(std::uint64_t{watched_.empty() ? 1u : 0u}, 8);
  for (std::uint64_t i = 0; i < loads; ++i) {
    Load load;
    load.content = &random_.one_of(contents());
    load.begin = soon(20'000);
    load.priority = static_cast<int>(random_.between(std::uint64_t{0}, 2)) * 500;
    const std::uint64_t size = load.content->versions[0]->size();
    if (random_.chance(0.4))
      for (std::uint64_t count = random_.between(std::uint64_t{1}, 6); count > 0; --count) {
        const std::uint64_t begin = random_.between(std::uint64_t{0}, size - 1);
        load.ranges.push_back({begin, std::min(size, begin + random_.between(std::uint64_t{1}, 40'000))});
      }
    if (random_.chance(0.2)) load.cancel = load.begin + Milliseconds(random_.between(std::uint64_t{0}, 5'000));
    loads_.push_back(std::move(load));
  }
  if (random_.chance(0.3)) {
    int version = 1;
    for (std::uint64_t count = random_.between(std::uint64_t{1}, 2); count > 0; --count, version = 1 - version) {
      const Content& content = random_.one_of(contents());
      uploads_[soon(20'000)] = {&content, version};
    }
  }
  if (!options_.cache_folder.empty() && random_.chance(0.3)) client_restart_ = soon(15'000);
  // Viewers open their streams at once.
  for (const Content* content : watched_)
    streams_.push_back(std::make_unique<StreamClient>(*this, *content, Random(random_.next()), trace_));
}

// Reports whether a failure is right: failures are long, the file has changed, or the server has never answered.
bool HttpSession::may_fail(const Content& content) const {
  return !survivable_ || changed_.contains(&content) || answers() == answers_before_;
}

std::uint64_t HttpSession::answers() const {
  std::uint64_t sum = 0;
  for (const auto& [status, count] : counts_.statuses) sum += count;
  return sum;
}

void HttpSession::open_engine() {
  answers_before_ = answers();
  queue_.emplace(options_.max_queued_bytes, options_.max_queued_bytes_per_request, nullptr);
  if (!options_.cache_folder.empty()) {
    auto opened =
        net::HttpCache::open({options_.cache_folder, std::uint64_t{4} << 20, 64, 0, options_.random}, unix_seconds());
    require(std::holds_alternative<std::unique_ptr<net::HttpCache>>(opened), "the cache cannot be opened");
    cache_ = std::move(std::get<std::unique_ptr<net::HttpCache>>(opened));
  }
  engine_ = std::make_unique<net::LoadEngine>(options_, *queue_, cache_.get());
  engine_->add_transport(net::TransportKind::http,
                         std::make_unique<HttpNetwork>(*site_, weather_, network_seed_++, options_, counts_, trace_));
}

net::RequestId HttpSession::request(net::Request request) {
  const net::RequestId id{++last_id_};
  Received& made = received_[id.value];
  for (const Content& content : contents())
    if (request.url.ends_with("/" + content.name)) made.content = &content;
  require(made.content != nullptr, "a request for an unknown URL: " + request.url);
  made.ranges = request.ranges;
  made.next = made.ranges.empty() ? 0 : made.ranges.front().begin;
  queue_->open(id, request.priority);
  engine_->request(id, std::move(request));
  return id;
}

void HttpSession::cancel(net::RequestId id) {
  received_.at(id.value).ended = true;
  queue_->close(id);
  engine_->cancel(id);
}

void HttpSession::begin_due() {
  for (Load& load : loads_) {
    if (!load.over && !load.id && load.begin <= now_) {
      net::Request wanted;
      wanted.url = "http://site.example/" + load.content->name;
      wanted.ranges = load.ranges;
      wanted.priority = load.priority;
      load.id = request(std::move(wanted));
    }
    if (!load.over && load.id && load.cancel && *load.cancel <= now_) {
      load.over = true;
      cancel(*load.id);
    }
  }
  while (!uploads_.empty() && uploads_.begin()->first <= now_) {
    const auto [content, version] = uploads_.begin()->second;
    files_.put(*content, version, unix_seconds());
    changed_.insert(content);
    trace_.note(microseconds(), "upload " + content->name);
    uploads_.erase(uploads_.begin());
  }
  if (client_restart_ && *client_restart_ <= now_) restart_client();
}

// The client's program ends at once, as in a crash, and begins again with the cache that remains.
void HttpSession::restart_client() {
  client_restart_.reset();
  ++restarts_;
  trace_.note(microseconds(), "client restarts");
  streams_.clear();
  ended_streams_.clear();
  engine_.reset();
  cache_.reset();
  received_.clear();
  open_engine();
  for (Load& load : loads_) load.id.reset();
  for (const Content* content : watched_)
    streams_.push_back(std::make_unique<StreamClient>(*this, *content, Random(random_.next()), trace_));
}

void HttpSession::check(const net::LoadEvent& event) {
  const auto found = received_.find(event.id.value);
  require(found != received_.end() && !found->second.ended, "an event of a request that has ended");
  Received& received = found->second;
  if (const auto* head = std::get_if<net::LoadHead>(&event.what)) {
    received.total = head->total;
    require(head->total.has_value(), "a head without a size");
    received.seen.assign(static_cast<std::size_t>(*head->total), false);
  } else if (const auto* data = std::get_if<net::LoadData>(&event.what)) {
    require(received.total.has_value(), "data without a head");
    const Content& content = *received.content;
    const Bytes& version = content.versions[content.versions[0]->size() == received.total ? 0 : 1];
    require(version->size() == received.total, "the size of " + content.name + " is that of no version");
    require(data->offset + data->bytes.size() <= version->size(), "data behind the end of " + content.name);
    require(std::memcmp(version->data() + data->offset, data->bytes.data(), data->bytes.size()) == 0,
            "other bytes than those of " + content.name);
    if (received.ranges.size() <= 1)
      require(data->offset == received.next, "bytes of " + content.name + " from " + std::to_string(data->offset) +
                                                 " on; expected " + std::to_string(received.next));
    received.next += data->bytes.size();
    for (std::size_t i = 0; i < data->bytes.size(); ++i) {
      require(!received.seen[static_cast<std::size_t>(data->offset) + i], "a byte of " + content.name + " came twice");
      received.seen[static_cast<std::size_t>(data->offset) + i] = true;
    }
    received.delivered += data->bytes.size();
    delivered_ += data->bytes.size();
  } else if (std::holds_alternative<net::LoadRestarted>(event.what)) {
    require(changed_.contains(received.content), received.content->name + " restarted without a change");
    received.total.reset();
    received.next = received.ranges.empty() ? 0 : received.ranges.front().begin;
    received.delivered = 0;
  } else {
    received.ended = true;
  }
}

void HttpSession::take(net::LoadEvent& event) {
  check(event);
  for (const auto& stream : streams_)
    if (stream->take(event, microseconds())) return check_stream(*stream);
  for (Load& load : loads_) {
    if (load.over || load.id != event.id) continue;
    const bool done = std::holds_alternative<net::LoadDone>(event.what);
    const auto* error = std::get_if<net::LoadError>(&event.what);
    if (!done && !error) return;
    load.over = true;
    trace_.note(microseconds(), "load " + load.content->name + (error ? ": " + error->message : " done"));
    if (error) {
      ++failed_;
      require(may_fail(*load.content), "a load failed although all failures were short: " + error->message);
    }
    if (done && load.ranges.empty())
      require(received_.at(event.id.value).delivered == received_.at(event.id.value).total,
              load.content->name + " is done, but bytes are missing");
    return;
  }
}

void HttpSession::check_stream(const StreamClient& stream) {
  if (!stream.over() || !ended_streams_.insert(&stream).second) return;
  require(stream.problem().empty() || may_fail(stream.content()),
          "a stream failed although all failures were short: " + stream.problem());
}

void HttpSession::poll() {
  const std::size_t most = random_.chance(0.3) ? 20'000 : 4 << 20;
  for (net::LoadEvent& event : queue_->poll(most)) {
    // A client that handles an event may cancel the request of a later one.
    const auto found = received_.find(event.id.value);
    if (found != received_.end() && found->second.ended) continue;
    take(event);
  }
  require(queue_->queued_bytes() <= options_.max_queued_bytes + 32 * 16'384, "the queue exceeds its limit");
}

bool HttpSession::over() const {
  return !client_restart_ && std::ranges::all_of(loads_, [](const Load& load) { return load.over; }) &&
         std::ranges::all_of(streams_, [](const auto& stream) { return stream->over(); });
}

TimePoint HttpSession::next_event(std::optional<TimePoint> deadline) const {
  TimePoint next = next_poll_;
  if (deadline) next = std::min(next, *deadline);
  if (!streams_.empty()) next = std::min(next, next_draw_);
  for (const Load& load : loads_) {
    if (!load.over && !load.id) next = std::min(next, load.begin);
    if (!load.over && load.id && load.cancel) next = std::min(next, *load.cancel);
  }
  if (!uploads_.empty()) next = std::min(next, uploads_.begin()->first);
  if (client_restart_) next = std::min(next, *client_restart_);
  return next;
}

SessionResult HttpSession::run() {
  const TimePoint begin = now_;
  for (std::size_t steps = 0; !over(); ++steps) {
    require(steps < kMostHttpSteps && now_ - begin < kLongestHttp, "the session does not end");
    begin_due();
    const auto deadline = engine_->step(now_);
    if (next_poll_ <= now_) {
      poll();
      next_poll_ = now_ + Milliseconds(random_.between(std::uint64_t{1}, 100));
    }
    if (next_draw_ <= now_) {
      for (const auto& stream : streams_) {
        stream->draw(microseconds());
        check_stream(*stream);
      }
      next_draw_ = now_ + Milliseconds(random_.between(std::uint64_t{16}, 300));
    }
    const TimePoint next = next_event(deadline);
    now_ = std::max(next, now_ + std::chrono::microseconds(1));
  }
  for (const auto& stream : streams_) {
    pictures_ += stream->pictures();
    if (!stream->problem().empty()) ++failed_;
  }
  // A byte is received again only after a failure or a change, or in a gap that is shorter than another request.
  const bool calm = counts_.breaks + counts_.timeouts + counts_.refusals == 0 && changed_.empty() && restarts_ == 0;
  require(!calm || counts_.body_bytes <= delivered_ + counts_.requests * options_.join_gap,
          std::to_string(counts_.body_bytes) + " bytes were sent, but only " + std::to_string(delivered_) + " needed");
  const auto milliseconds = static_cast<std::uint64_t>((now_ - begin) / Milliseconds(1));
  SessionResult result;
  result.counts = {{"HTTP requests", counts_.requests},
                   {"HTTP body bytes", counts_.body_bytes},
                   {"delivered bytes", delivered_},
                   {"broken transfers", counts_.breaks},
                   {"refused connections", counts_.refusals},
                   {"time-outs", counts_.timeouts},
                   {"restarts of clients", restarts_},
                   {"uploads", changed_.size()},
                   {"HTTP pictures", pictures_},
                   {"failed loads and streams", failed_},
                   {"HTTP milliseconds", milliseconds}};
  for (const auto& [name, count] : result.counts) trace_.note(microseconds(), name + ": " + std::to_string(count));
  result.hash = trace_.hash();
  return result;
}

}  // namespace

SessionResult run_http_session(std::uint64_t seed, bool prints) { return HttpSession(seed, prints).run(); }

}  // namespace gs::simulation
