#include "app/serve/live_relay.h"

#include "app/loading/updates/live_data.h"
#include "net/base/url.h"
#include "net/control/live_file.h"
#include "net/serve/served_folder.h"

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <memory>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

using RelayClock = std::chrono::steady_clock;

constexpr std::uint64_t kMostRelayedBytes = std::uint64_t{256} << 20;
constexpr std::size_t kMostRelayed = 64, kMostRelayedChanges = 16;
// Time for which a received resource is kept: streams and chunks never change, others do. Above the limits, all are
// kept for a short time only, which suffices for the requests that wait for them.
constexpr std::chrono::milliseconds kKeptSteady{10'000}, kKeptChanging{200}, kKeptAboveLimits{500};

bool is_steady(const std::string& resource) {
  return resource.ends_with(".qnv") || resource.find(".zarr/") != std::string::npos;
}

template <class Future>
bool is_ready(const Future& one) {
  return one.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

std::string relayed_type(const std::string& resource) {
  if (resource.empty()) return "model/vrml";
  if (resource.ends_with(".json")) return "application/json";
  return resource.ends_with(".qnv") ? "model/x-qnv" : "application/octet-stream";
}

// Returns the URL of a resource on the server that a file names; "" if the file is invalid or the server is elsewhere.
std::string url_of_live(const net::LiveFile& file, const std::string& resource) {
  const std::string address = net::address_of_live(file, net::name_of_machine());
  if (address.empty()) return {};
  std::string url = "http://" + address;
  for (std::size_t begin = 0; begin <= resource.size();) {
    const std::size_t end = std::min(resource.find('/', begin), resource.size());
    url += "/" + net::encode_name(resource.substr(begin, end - begin));
    begin = end + 1;
  }
  return url;
}

}  // namespace

std::optional<LivePath> live_path(std::string_view path) {
  for (std::size_t at = path.find(kLiveFileEnding); at != std::string_view::npos;
       at = path.find(kLiveFileEnding, at + 1)) {
    const std::size_t end = at + kLiveFileEnding.size();
    if (end < path.size() && path[end] == '/' && at > 0 && path[at - 1] != '/')
      return LivePath{(path.starts_with('/') ? "" : "/") + std::string(path.substr(0, end)),
                      std::string(path.substr(end + 1))};
  }
  return std::nullopt;
}

net::HeldContent LiveRelay::content(const net::ContentRequest& request) {
  using State = net::HeldContent::State;
  const auto path = live_path(request.path);
  if (!path) return {};
  // Serves only documents that may read no more than the resources below a file of a simulation.
  if (!request.within.empty() && !live_path(request.within)) return {};
  keep_recent();
  const auto found = pending_.find(request.path);
  if (found == pending_.end()) {
    if (pending_.size() >= kMostRelayed) return {State::waiting, {}, {}};
    auto file = net::read_live_file(path->file);
    const auto* const known = std::get_if<net::LiveFile>(&file);
    const std::string url = known ? url_of_live(*known, path->resource) : std::string();
    if (url.empty()) return {};
    net::Request wanted;
    wanted.url = url;
    // The authorization disables redirects. So the client cannot reach other servers through this relay.
    wanted.authorization = "Bearer " + known->token;
    pending_[request.path].running = send(std::move(wanted), kMostRelayedBytes);
    return {State::waiting, {}, {}};
  }
  const Pending& pending = found->second;
  if (!pending.body) return {State::waiting, {}, {}};
  if (pending.body->empty()) return {pending.gone ? State::gone : State::none, {}, {}};
  return {State::ready, relayed_type(path->resource), *pending.body};
}

// Sends a request on another thread. The answer is ready before `wake_` is called, so that the server finds it at once.
LiveRelay::Running LiveRelay::send(net::Request wanted, std::uint64_t most_bytes) {
  const auto answer = std::make_shared<std::promise<SmallAnswer>>();
  Running running{answer->get_future(), {}};
  running.thread = std::async(std::launch::async, [this, answer, most_bytes, wanted = std::move(wanted)] {
    try {
      answer->set_value(small_request(wanted, false, load_, stop_, most_bytes));
    } catch (const std::exception&) {
      answer->set_exception(std::current_exception());
    }
    wake_();
  });
  return running;
}

// Receives finished answers, also those that nobody waits for any more. Drops old ones.
void LiveRelay::keep_recent() {
  const auto now = RelayClock::now();
  std::uint64_t bytes = 0;
  for (auto& [path, one] : pending_) {
    if (!one.body && is_ready(one.running.coming)) {
      SmallAnswer answer = one.running.coming.get();
      one.body = answer.problem.empty() ? std::move(answer.body) : std::string();
      const bool steady = !one.body->empty() && is_steady(live_path(path)->resource);
      constexpr int kGone = 410;
      one.gone = answer.status == kGone;
      one.came = now;
      one.kept = steady ? kKeptSteady : kKeptChanging;
    }
    bytes += one.body ? one.body->size() : 0;
  }
  const bool full = pending_.size() >= kMostRelayed || bytes > kMostRelayedBytes;
  std::erase_if(pending_, [&](const auto& one) {
    return one.second.body &&
           now - one.second.came > (full ? std::min(one.second.kept, kKeptAboveLimits) : one.second.kept);
  });
}

net::PostAnswer LiveRelay::post(const net::PostRequest& request) {
  const auto parsed = net::parse_request_path(request.path, true);
  const auto* const names = std::get_if<net::RequestPath>(&parsed);
  if (!names) return {404, "not found"};
  std::string decoded;
  for (const std::string& name : names->names) {
    const char* const home = decoded.empty() && name == "~" ? std::getenv("HOME") : nullptr;
    decoded += home ? home : "/" + name;
  }
  const auto path = live_path(decoded);
  if (!path) return {405, "only the parameters of a simulation can be changed"};
  auto file = net::read_live_file(path->file);
  if (const auto* const problem = std::get_if<std::string>(&file)) return {404, *problem};
  const auto& known = std::get<net::LiveFile>(file);
  net::Request wanted;
  wanted.url = url_of_live(known, path->resource);
  if (wanted.url.empty())
    return {404,
            "the simulation runs on another machine and accepts only local connections; set bind to an address of its "
            "node"};
  if (!request.query.empty()) wanted.url += "?" + request.query;
  wanted.post = true;
  wanted.authorization = "Bearer " + known.token;
  // Destroying a running request would block, so the list keeps it.
  std::erase_if(posts_, [](const Change& one) { return is_ready(one.coming); });
  if (posts_.size() >= kMostRelayedChanges) return {503, "too many changes wait for the simulation; retry later"};
  Running running = send(std::move(wanted));
  posts_.push_back({running.coming.share(), std::move(running.thread)});
  net::PostAnswer waits;
  waits.later = [coming = posts_.back().coming]() -> std::optional<net::PostAnswer> {
    if (!is_ready(coming)) return std::nullopt;
    const std::string& problem = coming.get().problem;
    return problem.empty() ? net::PostAnswer{200, "ok"} : net::PostAnswer{400, problem};
  };
  return waits;
}

}  // namespace gs::app
