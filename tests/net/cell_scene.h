#pragma once

#include "net/cells/cell_receiver.h"
#include "net/cells/cell_sender.h"
#include "tests/net/link.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gs::net {

/// Source with bytes that are a function of their positions, so that a test can check received bytes.
class PatternSource : public CellSource {
 public:
  struct Stream {
    bool records = true;
    std::uint32_t chunks = 0, bytes = 0;  // chunks per stream; bytes of a chunk's body
  };
  PatternSource(std::size_t base, std::vector<Stream> streams, std::uint32_t version = 7)
      : base_(base), streams_(std::move(streams)), version_(version) {
    for (std::size_t i = 0; i < base; ++i) base_[i] = static_cast<std::byte>(i * 7 + (i >> 8));
  }
  /// Fills the bytes of a chunk from `offset` on. Each number gives eight bytes.
  static void fill(std::span<std::byte> bytes, std::size_t stream, std::uint32_t chunk, std::size_t offset) {
    for (std::size_t done = 0; done < bytes.size();) {
      std::uint64_t state = stream << 56 | std::uint64_t{chunk} << 24 | (offset + done) / 8;
      const std::uint64_t number = Link::next_random(state);
      const std::size_t first = (offset + done) % 8, count = std::min(8 - first, bytes.size() - done);
      std::memcpy(bytes.data() + done, reinterpret_cast<const std::byte*>(&number) + first, count);
      done += count;
    }
  }
  static std::byte head_at(std::uint32_t chunk, std::size_t offset) {
    return static_cast<std::byte>(chunk * 3 + offset);
  }
  std::uint32_t version() const override { return version_; }
  std::span<const std::byte> base() const override { return base_; }
  std::size_t streams() const override { return streams_.size(); }
  bool records(std::size_t stream) const override { return streams_[stream].records; }
  std::uint32_t chunks(std::size_t stream) const override { return streams_[stream].chunks; }
  /// The x axis is divided among the chunks of a stream.
  std::optional<CellBox> box(std::size_t stream, std::uint32_t chunk) const override {
    const std::uint32_t step = 65536 / std::max(streams_[stream].chunks, 1U);
    return CellBox{static_cast<std::uint16_t>(chunk * step),
                   0,
                   0,
                   static_cast<std::uint16_t>(chunk * step + step - 1),
                   65535,
                   65535};
  }
  std::optional<CellChunk> chunk(std::size_t stream, std::uint32_t number) override {
    ++read_;
    CellChunk chunk;
    if (streams_[stream].records) chunk.head.resize(58);
    for (std::size_t i = 0; i < chunk.head.size(); ++i) chunk.head[i] = head_at(number, i);
    chunk.body.resize(streams_[stream].bytes);
    fill(chunk.body, stream, number, 0);
    return chunk;
  }
  std::uint64_t total() const {
    std::uint64_t sum = 0;
    for (const Stream& stream : streams_) sum += std::uint64_t{stream.chunks} * stream.bytes;
    return sum;
  }
  std::uint32_t chunk_size(std::size_t stream) const { return streams_[stream].bytes; }
  std::size_t read() const { return read_; }

 private:
  std::vector<std::byte> base_;
  std::vector<Stream> streams_;
  std::uint32_t version_;
  std::size_t read_ = 0;
};

class PatternLibrary : public CellLibrary {
 public:
  std::map<std::string, std::shared_ptr<CellSource>> sources;
  std::variant<std::shared_ptr<CellSource>, std::string> open(const std::string& path) override {
    const auto found = sources.find(path);
    if (found == sources.end()) return "there is no " + path;
    return found->second;
  }
};

using Streams = std::vector<PatternSource::Stream>;

/// Returns options of a server with a response to losses and a secret of two numbers: `secret` and its successor.
inline CellServerOptions server_options(CongestionResponse response = CongestionResponse::reserved,
                                        std::uint64_t secret = 1) {
  CellServerOptions options;
  options.secret = {secret, secret + 1};
  options.session.response = response;
  return options;
}

/// Returns a library with one source, "a".
inline std::shared_ptr<PatternLibrary> library(const std::shared_ptr<CellSource>& source) {
  auto made = std::make_shared<PatternLibrary>();
  made->sources["a"] = source;
  return made;
}

inline CellWish wish(std::string path = "a") {
  CellWish result;
  result.path = std::move(path);
  return result;
}

/// Data of one client, checked byte by byte.
struct ReceivedCells {
  bool ok = true, base = false, ended = false, failed = false, refused = false;
  Instant base_at{}, ended_at{}, first_piece_at{};
  std::uint64_t bytes = 0, pieces = 0;
  std::vector<ChunkName> order;
  std::string text;
  std::map<int, std::uint64_t> slot_bytes;
  std::map<ChunkName, std::uint64_t> chunk_bytes;

  /// Counts the complete chunks.
  std::uint64_t whole_chunks(const PatternSource& source) const {
    return static_cast<std::uint64_t>(std::count_if(chunk_bytes.begin(), chunk_bytes.end(), [&](const auto& entry) {
      return entry.second == source.chunk_size(entry.first.stream);
    }));
  }

  void take(const std::vector<CellEvent>& events, const CellSource& source, Instant now) {
    for (const CellEvent& event : events) switch (event.kind) {
        case CellEvent::Kind::base:
          ok = ok && std::equal(event.bytes.begin(), event.bytes.end(), source.base().begin(), source.base().end());
          if (!base) base_at = now;
          base = true;
          break;
        case CellEvent::Kind::piece:
          check(event);
          if (pieces++ == 0) first_piece_at = now;
          bytes += event.bytes.size();
          slot_bytes[event.slot] += event.bytes.size();
          chunk_bytes[event.name] += event.bytes.size();
          if (order.empty() || order.back() != event.name) order.push_back(event.name);
          break;
        case CellEvent::Kind::ended:
          if (!ended) ended_at = now;
          ended = true;
          break;
        case CellEvent::Kind::failed:
          failed = true;
          text = event.text;
          break;
        case CellEvent::Kind::refused:
          refused = true;
          text = event.text;
          break;
        default:
          break;
      }
  }
  void check(const CellEvent& event) {
    ok = ok && event.offset + event.bytes.size() <= event.total;
    std::vector<std::byte> expected(event.bytes.size());
    PatternSource::fill(expected, event.name.stream, event.name.chunk, event.offset);
    ok = ok && (expected.empty() || std::memcmp(expected.data(), event.bytes.data(), expected.size()) == 0);
    for (std::size_t i = 0; i < event.head.size(); ++i)
      ok = ok && event.head[i] == PatternSource::head_at(event.name.chunk, i);
    ok = ok && (event.records ? event.head.size() == 58 && event.offset % 8 == 0 && event.bytes.size() % 8 == 0
                              : event.bytes.size() == event.total);
  }
};

/// Server and clients in simulated time. Each client has its own link.
class Scene {
 public:
  struct Client {
    Client(const CellClientOptions& options, const Link::Options& link, std::uint64_t seed)
        : client(options),
          up(Link::Options{link.latency, link.bandwidth, link.queue, link.loss, link.duplicated, link.reordered,
                           link.reordered_by, link.cut, link.burst},
             seed),
          down(link, seed + 1000) {}
    CellClient client;
    Link up, down;
    ReceivedCells got;
    std::shared_ptr<CellSource> source;
  };
  Scene(const CellServerOptions& options, std::shared_ptr<PatternLibrary> library)
      : server(options, std::move(library)) {}

  std::size_t add(const Link::Options& link, std::shared_ptr<CellSource> source, std::uint64_t rate = 10'000'000,
                  std::uint64_t seed = 1) {
    CellClientOptions options;
    options.nonce = 1000 + clients.size() * 7919 + seed;
    options.rate = rate;
    clients.push_back(std::make_unique<Client>(options, link, seed + clients.size() * 17));
    clients.back()->source = std::move(source);
    return clients.size() - 1;
  }
  static Endpoint endpoint(std::size_t client) {
    Endpoint result;
    result.address[15] = static_cast<std::uint8_t>(client + 1);
    result.address[14] = static_cast<std::uint8_t>((client + 1) >> 8);
    result.port = 4000;
    return result;
  }
  /// Runs until a time, or until `until` returns true.
  template <class Until>
  void run(Instant end, Until until) {
    while (now <= end && !until()) {
      step();
      Instant next = server.deadline(now);
      for (auto& client : clients)
        next = std::min({next, client->client.deadline(now), client->up.deadline(), client->down.deadline()});
      if (shared) next = std::min(next, shared->deadline());
      if (next == Instant::max()) break;
      now = std::max(next, now + Instant(1));
    }
  }
  void run(Instant end) {
    run(end, [] { return false; });
  }
  /// Sends all data of the server through one link before the clients' own.
  void share_link(const Link::Options& link) { shared.emplace(link, 99); }
  void step() {
    while (auto bytes = shared ? shared->take(now) : std::nullopt) {
      const std::size_t index = std::to_integer<std::size_t>(bytes->back());
      bytes->pop_back();
      clients[index]->down.send(*bytes, now);
    }
    for (std::size_t i = 0; i < clients.size(); ++i) {
      Client& client = *clients[i];
      while (auto bytes = client.up.take(now)) server.receive(endpoint(i), *bytes, now);
      while (auto bytes = client.down.take(now)) client.client.receive(*bytes, now);
      while (auto bytes = client.client.next(now)) client.up.send(*bytes, now);
      client.got.take(client.client.take_events(), *client.source, now);
    }
    while (auto out = server.next(now)) {
      const std::size_t index = std::size_t{out->to.address[14]} * 256 + out->to.address[15] - 1;
      if (index >= clients.size()) continue;
      if (shared) {
        out->bytes.push_back(static_cast<std::byte>(index));
        shared->send(out->bytes, now);
      } else {
        clients[index]->down.send(out->bytes, now);
      }
    }
  }

  CellServer server;
  std::optional<Link> shared;
  std::vector<std::unique_ptr<Client>> clients;
  Instant now{1'000'000};
};

}  // namespace gs::net
