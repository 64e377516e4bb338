#include "app/base/local_file.h"
#include "app/world/scene_handler.h"
#include "app/world/world_loading.h"
#include "net/base/schemes.h"
#include "net/load/transport.h"

#include <algorithm>
#include <utility>

// Fetches from their first candidate to their end; local files and data: URLs.
namespace gs::app {
namespace {

/// Bytes of a local file between two checks of the time limit.
constexpr std::size_t kLocalBytes = std::size_t{4} << 20;

}  // namespace

void WorldLoading::State::fetch(std::unique_ptr<Fetch> wanted, Urgency urgency) {
  if (phase == Phase::too_many_files || phase == Phase::stopped) return;
  // A fetch asked for this one and must not be stopped here; the next step stops loading.
  phase = ++files > budget->limits().files ? Phase::too_many_files : Phase::loading;
  if (phase == Phase::too_many_files) return;
  wanted->priority = static_cast<int>(urgency) * kUrgencyStep;
  wanted->row = ledger->begin({}, {}, wanted->node);
  fetches.push_back(std::move(wanted));
  begin_next_candidate(*fetches.back());
}

void WorldLoading::State::begin_next_candidate(Fetch& fetch) {
  while (fetch.next < fetch.candidates.size()) {
    net::Url& url = fetch.candidates[fetch.next++];
    // Silent cell servers are compared by this spelling.
    if (auto canonical = net::canonical_url(url)) url = std::move(*canonical);
    ledger->seek(fetch.row, net::url_for_messages(url.text()), url.scheme.empty() ? "file" : url.scheme);
    if (const auto refused = policy.refuse(fetch.from, url)) {
      fail_candidate(fetch, refused->message, refused->folder);
      continue;
    }
    if (url.scheme.empty() || url.scheme == "file" || url.scheme == "data") {
      local.push_back(&fetch);
      return;
    }
    if (options.offline) {
      fail_candidate(fetch, net::url_for_messages(url.text()) + ": the network is disabled (--offline)");
      continue;
    }
    if (const net::Scheme* scheme = net::find_scheme(url.scheme);
        scheme && scheme->transport == net::TransportKind::cells) {
      if (begin_cells(fetch, url)) return;
      continue;
    }
    std::vector<net::ByteRange> ranges;
    if (fetch.max_bytes != Fetch::kNoLimit) ranges = {{0, fetch.max_bytes}};
    const bool is_long = options.by_view && ranges.empty() && url.path.ends_with(".qnv");
    fetch.part = is_long ? Fetch::Part::front : Fetch::Part::all;
    if (is_long) ranges = {{0, kFrontBytes}};
    return ask(fetch, std::move(ranges));
  }
  ended.push_back(&fetch);
  ledger->end(fetch.row, LoadStage::failed, fetch.first_problem);
  fetch.handler->told = fetch.told;
  fetch.handler->missing(fetch.first_problem);
}

void WorldLoading::State::fail_candidate(Fetch& fetch, const std::string& why, const std::string& folder) {
  const bool known = !folder.empty() && !refuse_folder(folder, fetch.reference);
  if (!fetch.first_problem.empty()) return;
  fetch.first_problem = why;
  fetch.told = known;
}

// Records a refused folder. Returns true if it was not reported before.
bool WorldLoading::State::refuse_folder(const std::string& folder, const std::string& reference) {
  constexpr std::size_t kMaxFolders = 64;
  const auto same = [&](const OutsideFolder& one) { return one.folder == folder; };
  if (std::any_of(world.outside.begin(), world.outside.end(), same)) return false;
  if (world.outside.size() < kMaxFolders) world.outside.push_back({folder, reference});
  return true;
}

// Local files and data: URLs

bool WorldLoading::State::begin_local(Fetch& fetch, const net::Url& url) {
  Found found;
  found.url = url;
  found.fragment = std::exchange(found.url.fragment, {});
  found.url.has_fragment = false;
  if (url.scheme == "data") {
    auto decoded = net::decode_data_url(url.text());
    if (!decoded) {
      fail_candidate(fetch, "malformed data: URL");
      return false;
    }
    fetch.data = std::move(decoded->bytes);
    fetch.rest = fetch.data;
    found.path = "data: URL";
    // A text inside another has its origin. A data: URL from the user may contain text of anyone, so it is not trusted.
    found.origin = fetch.from.is_user() ? net::Origin{"data:", net::AddressSpace::global} : fetch.from;
  } else {
    found.local = true;
    const std::string name = fetch.given_path.empty() ? net::path_of_url(url) : fetch.given_path;
    LocalFile file = open_local_file(url, policy, fetch.from, fetch.given_path, [&](std::span<const std::byte> first) {
      return fetch.handler->refuse_first(name, first);
    });
    if (!file.file) {
      fail_candidate(fetch, file.problem, file.folder);
      return false;
    }
    fetch.file = std::move(file.file);
    fetch.rest = fetch.file->bytes();
    found.path = fetch.given_path.empty() ? file.path : fetch.given_path;
    if (fetch.given_path.empty()) found.url = net::url_of_path(file.path);
    found.origin = {found.url.text()};
  }
  fetch.total = fetch.rest.size();
  if (fetch.rest.size() > fetch.max_bytes) {
    fetch.cut = true;
    fetch.rest = fetch.rest.first(static_cast<std::size_t>(fetch.max_bytes));
  }
  begin_taking(fetch, found);
  if (fetch.stage != Fetch::Stage::receiving || !fetch.file || fetch.cut) return true;
  const std::size_t size = fetch.rest.size();
  const bool taken_away = fetch.handler->take_file(*fetch.file);
  if (!taken_away && !fetch.handler->whole_file(*fetch.file, found.path)) return true;
  if (taken_away) fetch.file.reset();
  received += size;
  fetch.received = size;
  ledger->receive(fetch.row, size, size);
  fetch.rest = {};
  return true;
}

void WorldLoading::State::local_step() {
  Fetch& fetch = *local.front();
  if (fetch.stage == Fetch::Stage::seeking) {
    const net::Url url = fetch.candidates[fetch.next - 1];
    if (!begin_local(fetch, url)) {
      local.pop_front();
      return begin_next_candidate(fetch);
    }
  }
  if (fetch.stage == Fetch::Stage::receiving && !fetch.rest.empty()) {
    const auto piece = fetch.rest.first(std::min(kLocalBytes, fetch.rest.size()));
    fetch.rest = fetch.rest.subspan(piece.size());
    deliver(fetch, piece);
    if (fetch.file) fetch.file->put_aside(static_cast<std::size_t>(fetch.received));
  }
  if (fetch.stage == Fetch::Stage::receiving && !fetch.rest.empty()) return;
  local.pop_front();
  finish(fetch, fetch.file ? fetch.file->changed() : std::nullopt);
}

// Received bytes

void WorldLoading::State::begin_taking(Fetch& fetch, const Found& found) {
  fetch.stage = fetch.handler->begin(found) ? Fetch::Stage::receiving : Fetch::Stage::refused;
}

void WorldLoading::State::deliver(Fetch& fetch, std::span<const std::byte> bytes) {
  if (fetch.max_bytes != Fetch::kNoLimit && bytes.size() > fetch.max_bytes - fetch.received)
    bytes = bytes.first(static_cast<std::size_t>(fetch.max_bytes - fetch.received));
  fetch.received += bytes.size();
  received += bytes.size();
  fetch.handler->cut = fetch.cut;
  ledger->receive(fetch.row, bytes.size(), fetch.total);
  const bool before = std::exchange(changed, false);
  const std::size_t streams_before = world.feeds.size();
  if (!bytes.empty()) fetch.handler->receive(bytes);
  if (changed) ledger->show(fetch.row);
  changed = changed || before;
  if (world.feeds.size() > streams_before) ledger->follow(fetch.row, world.feeds.back().get(), false);
  if (fetch.total && *fetch.total > 0)
    fetch.handler->tell_progress(static_cast<double>(std::min(fetch.received, *fetch.total)) /
                                 static_cast<double>(*fetch.total));
}

void WorldLoading::State::finish(Fetch& fetch, const std::optional<std::string>& problem) {
  ended.push_back(&fetch);
  fetch.handler->cut = fetch.cut;
  if (fetch.stage == Fetch::Stage::refused)
    return ledger->end(fetch.row, LoadStage::failed, "its format is not usable here");
  const bool before = std::exchange(changed, false);
  fetch.handler->end(problem);
  if (changed) ledger->show(fetch.row);
  changed = changed || before;
  if (const auto useless = fetch.handler->wants_next()) {
    ended.pop_back();
    fetch.stage = Fetch::Stage::seeking;
    fetch.file.reset();
    fetch.data.clear();
    fetch.rest = {};
    fetch.received = 0;
    fetch.total.reset();
    fetch.cut = false;
    fail_candidate(fetch, *useless);
    return begin_next_candidate(fetch);
  }
  ledger->end(fetch.row, problem ? LoadStage::failed : LoadStage::whole, problem.value_or(""));
  if (!problem) fetch.handler->tell_progress(1);
}

}  // namespace gs::app
