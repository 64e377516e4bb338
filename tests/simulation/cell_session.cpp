#include "tests/simulation/cell_session.h"

#include "app/serve/cell_archive.h"
#include "app/streams/cell_stream.h"
#include "net/base/url.h"
#include "tests/net/link.h"
#include "tests/simulation/stream_viewer.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <variant>

namespace gs::simulation {
namespace {

using net::Instant;

constexpr Instant kSecond{1'000'000};
constexpr Instant kLongestCells = 3600 * kSecond;
constexpr std::size_t kMostCellSteps = 20'000'000;

/// Connection of a client without thread and socket.
class Connection final : public net::CellConnection {
 public:
  Connection(const net::CellClientOptions& options, const Instant& now) : client(options), now_(now) {}
  void want(std::size_t slot, net::CellWish wish) override { client.want(slot, std::move(wish), now_); }
  void prefer(std::size_t slot, std::vector<net::Region> regions, std::vector<net::ChunkName> chunks) override {
    client.prefer(slot, std::move(regions), std::move(chunks));
  }
  void forget(std::size_t slot, std::vector<net::ChunkName> chunks) override { client.forget(slot, chunks); }
  void set_rate(std::uint64_t bits_per_second) override { client.set_rate(bits_per_second); }
  std::vector<net::CellEvent> poll(std::size_t) override { return client.take_events(); }
  net::CellClientStatistics statistics() const override { return client.statistics(); }

  net::CellClient client;

 private:
  const Instant& now_;
};

/// Client that watches one stream.
struct Viewer {
  Viewer(const Content& watched, Random random, const net::Link::Options& up_link, const net::Link::Options& down_link)
      : content(&watched),
        picture(watched.name, Random(random.next())),
        up(up_link, random.next()),
        down(down_link, random.next()) {}

  const Content* content;
  StreamPicture picture;
  net::Link up, down;
  Connection* connection = nullptr;  // owned by the stream, until the stream is over
  std::unique_ptr<app::CellStream> stream;
  bool repairs = false, based = false;
  std::optional<std::string> problem;
  std::size_t chunks = 0, sent_everything = 0;
  Instant next_draw{};
};

class CellsSession {
 public:
  CellsSession(std::uint64_t seed, bool prints);
  SessionResult run();

 private:
  net::Link::Options plan_link();
  void add_viewer(const Content& content);
  void begin_server();
  void step();
  void follow_plan();
  void take_base(Viewer& viewer, const std::vector<std::byte>& base);
  void take_piece(Viewer& viewer, const net::CellEvent& event);
  static net::Endpoint endpoint(std::size_t viewer);

  Random random_;
  Trace trace_;
  ServedFiles files_;
  Instant now_{kSecond};
  std::shared_ptr<app::CellArchive> archive_;
  std::unique_ptr<net::CellServer> server_;  // null while it does not run
  std::vector<std::unique_ptr<Viewer>> viewers_;
  std::map<Instant, bool> server_changes_;  // runs from then on, or not
  std::map<Instant, bool> cuts_;            // links are cut from then on, or not
  std::map<Instant, const Content*> uploads_;
  std::set<const Content*> changed_;
  bool cut_ = false;
};

CellsSession::CellsSession(std::uint64_t seed, bool prints) : random_(seed), trace_(prints) {
  for (const Content& content : contents()) files_.put(content, 0, 1'700'000'000);
  auto opened = app::CellArchive::of_folder(files_.folder());
  require(std::holds_alternative<std::shared_ptr<app::CellArchive>>(opened), "the folder cannot be served");
  archive_ = std::move(std::get<std::shared_ptr<app::CellArchive>>(opened));
  begin_server();
  const auto plan = [this](std::map<Instant, bool>& changes, bool begins, std::uint64_t most_seconds) {
    Instant at = now_;
    for (std::uint64_t count = random_.between(std::uint64_t{1}, 3); count > 0; --count) {
      at += Instant(static_cast<std::int64_t>(random_.between(std::uint64_t{10'000}, 8'000'000)));
      changes[at] = begins;
      at += Instant(static_cast<std::int64_t>(random_.between(std::uint64_t{10'000}, most_seconds * 1'000'000)));
      changes[at] = !begins;
    }
  };
  if (random_.chance(0.4)) plan(cuts_, true, 10);
  if (random_.chance(0.4)) plan(server_changes_, false, 5);
  std::vector<const Content*> streams;
  for (const Content& content : contents())
    if (content.name.ends_with(".qnv")) streams.push_back(&content);
  if (random_.chance(0.2))
    uploads_[now_ + Instant(static_cast<std::int64_t>(random_.between(std::uint64_t{0}, 5'000'000)))] =
        random_.one_of(streams);
  for (std::uint64_t count = random_.between(std::uint64_t{1}, 4); count > 0; --count)
    add_viewer(*random_.one_of(streams));
}

void CellsSession::begin_server() {
  net::CellServerOptions options;
  options.secret = {random_.next(), random_.next()};
  if (random_.chance(0.3)) options.client_rate = 2'000'000;
  server_ = std::make_unique<net::CellServer>(options, archive_);
}

net::Link::Options CellsSession::plan_link() {
  net::Link::Options link;
  link.latency = Instant(static_cast<std::int64_t>(random_.between(std::uint64_t{500}, 150'000)));
  link.bandwidth = random_.one_of(std::vector<std::uint64_t>{0, 500'000, 2'000'000, 20'000'000});
  link.queue = static_cast<std::size_t>(random_.between(std::uint64_t{8'000}, 256'000));
  if (random_.chance(0.5)) link.loss = random_.between(0.0, 0.3);
  if (random_.chance(0.3)) link.burst = random_.between(1.0, 8.0);
  if (random_.chance(0.3)) link.duplicated = random_.between(0.0, 0.2);
  if (random_.chance(0.3)) link.reordered = random_.between(0.0, 0.2);
  return link;
}

net::Endpoint CellsSession::endpoint(std::size_t viewer) {
  net::Endpoint result;
  result.address[15] = static_cast<std::uint8_t>(viewer + 1);
  result.port = 4000;
  return result;
}

void CellsSession::add_viewer(const Content& content) {
  const net::Link::Options up = plan_link(), down = plan_link();
  viewers_.push_back(std::make_unique<Viewer>(content, Random(random_.next()), up, down));
  Viewer& viewer = *viewers_.back();
  viewer.repairs = random_.chance(0.7);
  net::CellClientOptions options;
  options.nonce = random_.next() | 1;
  auto connection = std::make_unique<Connection>(options, now_);
  viewer.connection = connection.get();
  app::CellStreamOptions settings;
  settings.rate = random_.one_of(std::vector<std::uint64_t>{0, 1'000'000, 10'000'000});
  settings.repair = viewer.repairs;
  app::CellStream::Sink sink;
  sink.granted = [] {};
  sink.base = [this, &viewer](const std::vector<std::byte>& base) { take_base(viewer, base); };
  sink.piece = [this, &viewer](const net::CellEvent& event) { take_piece(viewer, event); };
  sink.ended = [this, &viewer](const std::optional<std::string>& problem) {
    ++viewer.sent_everything;
    if (problem) viewer.problem = *problem;
    trace_.note(now_.count(), viewer.content->name + (problem ? " failed: " + *problem : " ended"));
  };
  viewer.stream = std::make_unique<app::CellStream>(net::parse_url("cells://site.example:6635/" + content.name),
                                                    settings, std::move(sink), std::move(connection));
}

void CellsSession::take_base(Viewer& viewer, const std::vector<std::byte>& base) {
  require(!viewer.based, "a second base of " + viewer.content->name);
  viewer.based = true;
  trace_.note(now_.count(), "base " + viewer.content->name + " " + std::to_string(base.size()));
  const auto is_front = [&](const Bytes& version) {
    return base.size() <= version->size() && std::memcmp(version->data(), base.data(), base.size()) == 0;
  };
  require(is_front(viewer.content->versions[0]) || is_front(viewer.content->versions[1]),
          "the base is not the start of " + viewer.content->name);
  require(viewer.picture.begin(base), "the base lacks a part of the header");
  viewer.stream->follow(viewer.picture.feed());
}

void CellsSession::take_piece(Viewer& viewer, const net::CellEvent& event) {
  ++viewer.chunks;
  if (viewer.chunks % 64 == 0) trace_.note(now_.count(), viewer.content->name + " " + std::to_string(viewer.chunks));
  viewer.picture.add_piece(event);
}

void CellsSession::follow_plan() {
  while (!server_changes_.empty() && server_changes_.begin()->first <= now_) {
    const bool runs = server_changes_.begin()->second;
    trace_.note(now_.count(), runs ? "server starts" : "server stops");
    if (runs)
      begin_server();
    else
      server_.reset();
    server_changes_.erase(server_changes_.begin());
  }
  while (!cuts_.empty() && cuts_.begin()->first <= now_) {
    cut_ = cuts_.begin()->second;
    trace_.note(now_.count(), cut_ ? "links are cut" : "links work");
    for (const auto& viewer : viewers_)
      for (net::Link* link : {&viewer->up, &viewer->down}) {
        net::Link::Options options = link->options();
        options.cut = cut_;
        link->set(options);
      }
    cuts_.erase(cuts_.begin());
  }
  while (!uploads_.empty() && uploads_.begin()->first <= now_) {
    const Content* const content = uploads_.begin()->second;
    files_.put(*content, 1, 1'700'001'000);
    changed_.insert(content);
    trace_.note(now_.count(), "upload " + content->name);
    uploads_.erase(uploads_.begin());
  }
}

void CellsSession::step() {
  follow_plan();
  for (std::size_t i = 0; i < viewers_.size(); ++i) {
    Viewer& viewer = *viewers_[i];
    while (auto bytes = viewer.up.take(now_))
      if (server_) server_->receive(endpoint(i), *bytes, now_);
    if (viewer.stream->over()) {
      while (viewer.down.take(now_)) continue;
      continue;
    }
    while (auto bytes = viewer.down.take(now_)) viewer.connection->client.receive(*bytes, now_);
    while (auto bytes = viewer.connection->client.next(now_)) viewer.up.send(*bytes, now_);
    viewer.stream->step();
    if (viewer.next_draw <= now_) {
      viewer.picture.draw(false);
      viewer.next_draw = now_ + Instant(static_cast<std::int64_t>(random_.between(std::uint64_t{30'000}, 400'000)));
    }
  }
  while (server_) {
    const auto out = server_->next(now_);
    if (!out) break;
    const std::size_t index = std::size_t{out->to.address[15]} - 1;
    require(index < viewers_.size(), "a datagram to an unknown address");
    viewers_[index]->down.send(out->bytes, now_);
  }
}

SessionResult CellsSession::run() {
  const Instant begin = now_;
  const auto over = [this] {
    return std::ranges::all_of(viewers_, [](const auto& viewer) {
      return viewer->stream->over() || (!viewer->repairs && viewer->sent_everything > 0);
    });
  };
  for (std::size_t steps = 0; !over(); ++steps) {
    require(steps < kMostCellSteps && now_ - begin < kLongestCells, "the session does not end");
    step();
    Instant next = server_ ? server_->deadline(now_) : Instant::max();
    for (const auto& viewer : viewers_) {
      next = std::min({next, viewer->up.deadline(), viewer->down.deadline()});
      if (!viewer->stream->over())
        next = std::min({next, viewer->connection->client.deadline(now_), viewer->next_draw});
    }
    for (const auto* changes : {&server_changes_, &cuts_})
      if (!changes->empty()) next = std::min(next, changes->begin()->first);
    if (!uploads_.empty()) next = std::min(next, uploads_.begin()->first);
    now_ = std::max(next, now_ + Instant(1));
  }
  std::size_t pictures = 0, failed = 0, chunks = 0;
  for (const auto& viewer : viewers_) {
    pictures += viewer->picture.pictures();
    chunks += viewer->chunks;
    if (viewer->problem) {
      ++failed;
      require(changed_.contains(viewer->content) || !viewer->based,
              viewer->content->name + " failed although its file did not change: " + *viewer->problem);
      continue;
    }
    if (viewer->based) viewer->picture.draw(true);
    if (viewer->repairs && !changed_.contains(viewer->content))
      viewer->picture.check_whole(viewer->content->versions[0]);
  }
  SessionResult result;
  result.counts = {{"cell viewers", viewers_.size()},
                   {"pieces", chunks},
                   {"cell pictures", pictures},
                   {"failed cell streams", failed},
                   {"cell milliseconds", static_cast<std::uint64_t>((now_ - begin).count() / 1000)}};
  for (const auto& [name, count] : result.counts) trace_.note(now_.count(), name + ": " + std::to_string(count));
  result.hash = trace_.hash();
  return result;
}

}  // namespace

SessionResult run_cell_session(std::uint64_t seed, bool prints) { return CellsSession(seed, prints).run(); }

}  // namespace gs::simulation
