#include "tests/simulation/http_network.h"

#include "net/http/http_headers.h"

#include <algorithm>
#include <utility>
#include <variant>

#include <unistd.h>

namespace gs::simulation {
namespace {

constexpr std::uint64_t kBlock = 16'384;
constexpr net::Milliseconds kResend{300};  // a typical time until TCP sends a lost packet again

net::TransferEnd failure(net::LoadErrorKind kind, const char* message, bool transient) {
  return {net::LoadError{kind, message}, transient};
}

}  // namespace

HttpNetwork::HttpNetwork(const net::HttpSite& site, Weather weather, std::uint64_t seed,
                         const net::LoaderOptions& options, HttpCounts& counts, Trace& trace)
    : site_(site), weather_(std::move(weather)), random_(seed), options_(options), counts_(counts), trace_(trace) {}

std::int64_t HttpNetwork::microseconds(net::TimePoint time) {
  return std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count();
}

net::TimePoint HttpNetwork::arrival(net::TimePoint time, bool may_be_lost) {
  for (const Period& cut : weather_.cuts)
    if (cut.contains(time)) time = cut.end + kResend;
  if (may_be_lost && random_.chance(weather_.lost)) time += kResend;
  return time + weather_.round_trip / 2;
}

const Period* HttpNetwork::restart_at(net::TimePoint time) const {
  for (const Period& restart : weather_.restarts)
    if (restart.contains(time)) return &restart;
  return nullptr;
}

bool HttpNetwork::restarted_between(net::TimePoint begin, net::TimePoint end) const {
  return std::ranges::any_of(weather_.restarts,
                             [&](const Period& restart) { return restart.begin > begin && restart.begin <= end; });
}

void HttpNetwork::start(net::TransferId id, const net::TransferRequest& request, net::TimePoint now) {
  Transfer transfer;
  transfer.request = request;
  transfer.heard = now;
  // A new connection costs one round trip more.
  const bool reused = idle_ > 0;
  if (reused) --idle_;
  transfer.next = arrival(reused ? now : arrival(now, true) + weather_.round_trip / 2, true);
  trace_.note(microseconds(now),
              "start " + std::to_string(id) + " " + request.url +
                  (request.range ? " " + std::to_string(request.range->begin) + "-" + std::to_string(request.range->end)
                                 : std::string()));
  transfers_.insert_or_assign(id, std::move(transfer));
}

void HttpNetwork::cancel(net::TransferId id) {
  if (const auto found = transfers_.find(id); found != transfers_.end()) found->second.over = true;
}

void HttpNetwork::pause(net::TransferId id, bool paused) {
  if (const auto found = transfers_.find(id); found != transfers_.end()) found->second.paused = paused;
}

void HttpNetwork::step(net::TransferSink& sink, net::TimePoint now) {
  for (auto& [id, transfer] : transfers_)
    while (!transfer.over && !transfer.paused && transfer.next <= now) advance(id, transfer, sink, now);
  std::erase_if(transfers_, [](const auto& entry) { return entry.second.over; });
}

std::optional<net::TimePoint> HttpNetwork::deadline(net::TimePoint now) const {
  std::optional<net::TimePoint> first;
  for (const auto& [id, transfer] : transfers_)
    if (transfer.over)
      return now;
    else if (!transfer.paused && (!first || transfer.next < *first))
      first = transfer.next;
  return first;
}

void HttpNetwork::end(net::TransferId id, Transfer& transfer, net::TransferSink& sink, net::TransferEnd how) {
  transfer.over = true;
  if (!how.error && idle_ < 6) ++idle_;
  trace_.note(microseconds(transfer.next),
              "end " + std::to_string(id) + (how.error ? " " + how.error->message : std::string()));
  sink.on_end(id, how);
}

void HttpNetwork::advance(net::TransferId id, Transfer& transfer, net::TransferSink& sink, net::TimePoint now) {
  const net::Milliseconds patience = transfer.state == Transfer::State::connecting ? options_.connect_timeout
                                     : transfer.state == Transfer::State::waiting  ? options_.head_timeout
                                                                                   : options_.stall_timeout;
  if (transfer.next > transfer.heard + patience) {
    ++counts_.timeouts;
    transfer.next = transfer.heard + patience;
    return end(id, transfer, sink, failure(net::LoadErrorKind::timed_out, "no bytes in time", true));
  }
  if (transfer.state != Transfer::State::connecting && restarted_between(transfer.heard, transfer.next)) {
    ++counts_.breaks;
    return end(id, transfer, sink, failure(net::LoadErrorKind::broken, "the server stopped", true));
  }
  switch (transfer.state) {
    case Transfer::State::connecting:
      return ask(id, transfer, sink, now);
    case Transfer::State::waiting: {
      net::ResponseHead head;
      head.status = transfer.answer.status;
      for (const auto& [name, value] : transfer.answer.headers)
        net::add_header(head, name, value, options_.unix_seconds());
      if (head.status != 304 && !head.content_length) head.content_length = transfer.answer.size();
      net::finish_head(head);
      transfer.state = Transfer::State::receiving;
      transfer.heard = transfer.next;
      schedule_block(transfer, transfer.next);
      const net::HeadVerdict verdict = sink.on_head(id, head);
      transfer.over = verdict == net::HeadVerdict::stop;
      transfer.discards = verdict == net::HeadVerdict::discard;
      return;
    }
    case Transfer::State::receiving:
      return deliver(id, transfer, sink, now);
  }
}

// The request reaches the server.
void HttpNetwork::ask(net::TransferId id, Transfer& transfer, net::TransferSink& sink, net::TimePoint) {
  ++counts_.requests;
  if (restart_at(transfer.next)) {
    ++counts_.refusals;
    return end(id, transfer, sink, failure(net::LoadErrorKind::unreachable, "the server cannot be reached", false));
  }
  net::HttpRequest request;
  request.method = "GET";
  request.target = transfer.request.url.substr(transfer.request.url.find('/', 7));
  request.hosts = {"site.example"};
  request.conditions.if_none_match = transfer.request.if_none_match;
  request.conditions.if_modified_since = transfer.request.if_modified_since;
  if (transfer.request.range) {
    const net::ByteRange range = *transfer.request.range;
    request.range = "bytes=" + std::to_string(range.begin) + "-" +
                    (range.end == net::kOpenEnd ? std::string() : std::to_string(range.end - 1));
    request.conditions.if_range = transfer.request.if_range;
  }
  if (random_.chance(weather_.busy))
    transfer.answer = site_.too_many(request);
  else
    transfer.answer = std::get<net::HttpAnswer>(site_.answer(request));
  ++counts_.statuses[transfer.answer.status];
  transfer.state = Transfer::State::waiting;
  transfer.heard = transfer.next;
  transfer.next = arrival(transfer.next, true);
}

// All transfers share the line, which takes one block after the other.
void HttpNetwork::schedule_block(Transfer& transfer, net::TimePoint now) {
  const std::uint64_t bytes = std::min(kBlock, transfer.answer.size() - transfer.sent);
  free_ = std::max(free_, now) + std::chrono::microseconds(bytes * 1'000'000 / weather_.bytes_per_second);
  const net::TimePoint arrives = arrival(free_, true) - weather_.round_trip / 2;
  transfer.next = std::max(transfer.next, arrives);
}

void HttpNetwork::deliver(net::TransferId id, Transfer& transfer, net::TransferSink& sink, net::TimePoint now) {
  if (transfer.sent == transfer.answer.size()) return end(id, transfer, sink, {});
  const std::vector<std::byte> bytes = bytes_of(transfer.answer, transfer.sent, kBlock);
  transfer.heard = transfer.next;
  if (bytes.empty() || random_.chance(weather_.broken)) {
    ++counts_.breaks;
    return end(id, transfer, sink, failure(net::LoadErrorKind::broken, "the connection was interrupted", true));
  }
  transfer.sent += bytes.size();
  counts_.body_bytes += bytes.size();
  schedule_block(transfer, now);
  if (transfer.discards) return;
  const net::DataVerdict verdict = sink.on_data(id, bytes);
  transfer.over |= verdict == net::DataVerdict::stop;
  transfer.paused |= verdict == net::DataVerdict::pause;
}

std::vector<std::byte> HttpNetwork::bytes_of(const net::HttpAnswer& answer, std::uint64_t from,
                                             std::size_t most) const {
  std::uint64_t begin = 0;
  for (const net::AnswerPart& part : answer.parts) {
    const std::uint64_t end = begin + part.size();
    if (from >= end) {
      begin = end;
      continue;
    }
    const std::uint64_t skip = from - begin;
    const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(most, part.size() - skip));
    std::vector<std::byte> bytes(count);
    if (!part.text.empty()) {
      const auto text = std::as_bytes(std::span(part.text)).subspan(static_cast<std::size_t>(skip), count);
      return {text.begin(), text.end()};
    }
    const ssize_t got = ::pread(answer.file->get(), bytes.data(), count, static_cast<off_t>(part.range.begin + skip));
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }
  return {};
}

}  // namespace gs::simulation
