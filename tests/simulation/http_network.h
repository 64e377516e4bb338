#pragma once

#include "net/transfer/transport.h"
#include "net/serve/http_site.h"
#include "tests/simulation/random.h"
#include "tests/simulation/trace.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::simulation {

/// Period from `begin` to before `end`.
struct Period {
  net::TimePoint begin, end;
  [[nodiscard]] bool contains(net::TimePoint time) const { return begin <= time && time < end; }
};

/// Properties and failures of a simulated connection to a server.
struct Weather {
  net::Milliseconds round_trip{50};
  std::uint64_t bytes_per_second = 1'000'000;
  double lost = 0;               // share of the blocks that TCP must send again, which delays all later ones
  double broken = 0;             // share of the blocks after which the connection breaks
  double busy = 0;               // share of the requests that get status 429
  std::vector<Period> cuts;      // nothing passes
  std::vector<Period> restarts;  // the server is not running; its connections break
};

/// Bytes and answers of a session, for its invariants.
struct HttpCounts {
  std::uint64_t requests = 0, body_bytes = 0, breaks = 0, refusals = 0, timeouts = 0;
  std::map<int, std::uint64_t> statuses;
};

/// Transport to a simulated server: a real HttpSite behind a connection with delays and failures. All times come from
/// the caller, so equal seeds give equal results.
class HttpNetwork final : public net::Transport {
 public:
  HttpNetwork(const net::HttpSite& site, Weather weather, std::uint64_t seed, const net::LoaderOptions& options,
              HttpCounts& counts, Trace& trace);

  void start(net::TransferId id, const net::TransferRequest& request, net::TimePoint now) override;
  void cancel(net::TransferId id) override;
  void pause(net::TransferId id, bool paused) override;
  void step(net::TransferSink& sink, net::TimePoint now) override;
  [[nodiscard]] std::optional<net::TimePoint> deadline(net::TimePoint now) const override;

 private:
  struct Transfer {
    enum class State : std::uint8_t { connecting, waiting, receiving } state = State::connecting;
    net::TransferRequest request;
    net::TimePoint next{}, heard{};  // time of the next event; of the last byte
    net::HttpAnswer answer;
    std::uint64_t sent = 0;
    bool discards = false, paused = false, over = false;
  };
  void advance(net::TransferId id, Transfer& transfer, net::TransferSink& sink, net::TimePoint now);
  void ask(net::TransferId id, Transfer& transfer, net::TransferSink& sink, net::TimePoint now);
  void deliver(net::TransferId id, Transfer& transfer, net::TransferSink& sink, net::TimePoint now);
  void end(net::TransferId id, Transfer& transfer, net::TransferSink& sink, net::TransferEnd how);
  /// Returns the arrival of something that leaves at `time`: after cuts of the network, and after resending.
  net::TimePoint arrival(net::TimePoint time, bool may_be_lost);
  [[nodiscard]] const Period* restart_at(net::TimePoint time) const;
  [[nodiscard]] bool restarted_between(net::TimePoint begin, net::TimePoint end) const;
  void schedule_block(Transfer& transfer, net::TimePoint now);
  [[nodiscard]] std::vector<std::byte> bytes_of(const net::HttpAnswer& answer, std::uint64_t from,
                                                std::size_t most) const;
  [[nodiscard]] static std::int64_t microseconds(net::TimePoint time);

  const net::HttpSite& site_;
  const Weather weather_;
  Random random_;
  const net::LoaderOptions& options_;
  HttpCounts& counts_;
  Trace& trace_;
  std::map<net::TransferId, Transfer> transfers_;
  unsigned idle_ = 0;      // connections that wait for another request
  net::TimePoint free_{};  // time at which the line can take another block
};

}  // namespace gs::simulation
