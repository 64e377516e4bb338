#include "app/loading/fetch/fetcher.h"

#include "app/base/local_file.h"
#include "app/loading/fetch/loading.h"
#include "net/base/schemes.h"
#include "net/transfer/transport.h"

#include <algorithm>
#include <utility>

// Fetches from the first candidate URL to the end. Reading of local files and data: URLs.
namespace gs::app {
namespace {

/// Bytes of a local file between two checks of the time limit.
constexpr std::size_t kLocalBytes = std::size_t{4} << 20;

}  // namespace

std::optional<double> received_part(std::span<const LoadingState> states) {
  std::uint64_t received = 0, total = 0;
  for (const LoadingState& state : states) {
    if (!state.total) return std::nullopt;
    received += state.received;
    total += *state.total;
  }
  if (total == 0) return std::nullopt;
  return std::min(1.0, static_cast<double>(received) / static_cast<double>(total));
}

Fetcher::Fetcher(Loading& loading) : loading_(loading), network_(loading), cells_(loading) {}

bool Fetcher::step(std::chrono::milliseconds wait) {
  bool busy = false;
  cancel_rows();
  follow_rate();
  // Local files come first, so that something is visible even with a short time limit.
  if (!local_.empty()) {
    local_step();
    busy = true;
  } else if (!refining_.empty()) {
    refine_step();
    busy = true;
  }
  if (!is_done() && !fetches_.empty() && ended_.size() < fetches_.size() && loading_.limit.over())
    stop("the time limit for loading was reached; the missing parts are left out");
  if (phase_ == Phase::too_many_files)
    stop("refers to more than " + std::to_string(loading_.budget->limits().files) + " files; skipped the rest");
  if (is_done() && !has_streams()) return false;
  busy = network_.step() || busy;
  busy = cells_.step() || busy;
  busy = network_.step_streams() || busy;
  for (Fetch* fetch : std::exchange(ended_, {}))
    std::erase_if(fetches_, [fetch](const auto& one) { return one.get() == fetch; });
  const bool ends_now = !is_done() && fetches_.empty();
  if (ends_now) phase_ = Phase::done;
  if (!busy && !is_done()) network_.set_priorities();
  if (busy || ends_now || (is_done() && !loading_.results.is_handed_over())) return !is_done() || has_streams();
  loading_.waker->wait(std::min(wait, kLongestWait));
  return true;
}

void Fetcher::restart() {
  if (!fetches_.empty()) return;
  files_ = 0;
  phase_ = Phase::done;
}

bool Fetcher::has_ended(const Fetch& fetch) const {
  return std::find(ended_.begin(), ended_.end(), &fetch) != ended_.end();
}

bool Fetcher::reads_for(const ContentHandler& handler) const {
  return std::any_of(fetches_.begin(), fetches_.end(),
                     [&](const auto& fetch) { return fetch->handler.get() == &handler && !has_ended(*fetch); });
}

LoadingState Fetcher::state() const {
  LoadingState result;
  result.received = received_;
  result.files = files_;
  result.waiting = fetches_.size();
  std::uint64_t left = 0;
  bool known = true;
  for (const auto& fetch : fetches_) {
    if (fetch->parts) result.received += *fetch->parts;
    known = known && fetch->total;
    if (fetch->total) left += std::max(*fetch->total, fetch->received) - fetch->received;
  }
  if (known) result.total = result.received + left;
  return result;
}

void Fetcher::drop_transfer(Fetch& fetch) {
  std::erase(local_, &fetch);
  std::erase(refining_, &fetch);
  cells_.stop(fetch);
  network_.cancel(fetch);
}

void Fetcher::withdraw(const std::function<bool(const ContentHandler&)>& is_unwanted) {
  for (const auto& one : fetches_) {
    // A fetch that was withdrawn before may refer to a handler that no longer exists.
    if (has_ended(*one) || !is_unwanted(*one->handler)) continue;
    loading_.ledger->end(one->row, LoadStage::cancelled, "another URL was set");
    drop_transfer(*one);
    ended_.push_back(one.get());
  }
}

void Fetcher::stop(const std::string& why) {
  if (std::exchange(phase_, Phase::stopped) == Phase::stopped) return;
  const bool cancelled = loading_.limit.cancelled && *loading_.limit.cancelled;
  if (!cancelled) loading_.results.report(Severity::error, loading_.results.file(), {}, why);
  network_.cancel_all();
  local_.clear();
  refining_.clear();
  // Each handler keeps its received part. It cannot start new fetches, because the phase is `stopped`.
  for (std::size_t i = 0; i < fetches_.size(); ++i) {
    Fetch& fetch = *fetches_[i];
    if (has_ended(fetch)) continue;
    fetch.handler->cut = true;
    cells_.stop(fetch);
    if (fetch.stage == Fetch::Stage::receiving) fetch.handler->end(std::nullopt);
    fetch.handler->stopped();
    loading_.ledger->end(fetch.row, cancelled ? LoadStage::cancelled : LoadStage::failed, cancelled ? "" : why);
  }
  ended_.clear();
  fetches_.clear();
}

void Fetcher::cancel_rows() {
  for (const std::uint64_t row : loading_.ledger->take_cancelled()) {
    network_.cancel_stream(row);
    cells_.cancel_stream(row);
    const auto fetch = std::find_if(fetches_.begin(), fetches_.end(), [&](const auto& one) { return one->row == row; });
    if (fetch != fetches_.end() && !has_ended(**fetch)) cancel(**fetch);
  }
}

// Stops a fetch. The handler keeps the received part.
void Fetcher::cancel(Fetch& fetch) {
  drop_transfer(fetch);
  ended_.push_back(&fetch);
  loading_.ledger->end(fetch.row, LoadStage::cancelled);
  fetch.handler->cut = true;
  if (fetch.stage == Fetch::Stage::receiving)
    fetch.handler->end(std::nullopt);
  else if (fetch.stage == Fetch::Stage::seeking)
    fetch.handler->missing("loading was cancelled");
  fetch.handler->stopped();
}

// Applies the bandwidth limit after the user has changed it.
void Fetcher::follow_rate() {
  const std::optional<std::uint64_t> asked = loading_.ledger->rate();
  if (!asked || *asked == loading_.options.rate) return;
  loading_.options.rate = *asked;
  network_.set_rate();
  cells_.set_rate();
}

void Fetcher::leave_to_views(Fetch& fetch) {
  fetch.handler->tell_progress(1);
  ended_.push_back(&fetch);
}

void Fetcher::fetch(std::unique_ptr<Fetch> wanted, Urgency urgency) {
  if (phase_ == Phase::too_many_files || phase_ == Phase::stopped) return;
  // The caller may be another fetch, which must not be stopped here. The next step stops loading.
  phase_ = ++files_ > loading_.budget->limits().files ? Phase::too_many_files : Phase::loading;
  if (phase_ == Phase::too_many_files) return;
  wanted->priority = static_cast<int>(urgency) * kUrgencyStep;
  wanted->row = loading_.ledger->begin({}, {}, wanted->node);
  fetches_.push_back(std::move(wanted));
  begin_next_candidate(*fetches_.back());
}

void Fetcher::begin_next_candidate(Fetch& fetch) {
  while (fetch.next < fetch.candidates.size()) {
    net::Url& url = fetch.candidates[fetch.next++];
    // The set of silent cell servers uses the canonical spelling of URLs.
    if (auto canonical = net::canonical_url(url)) url = std::move(*canonical);
    loading_.ledger->seek(fetch.row, net::url_for_messages(url.text()), url.scheme.empty() ? "file" : url.scheme);
    if (const auto refused = policy_.refuse(fetch.from, url)) {
      fail_candidate(fetch, refused->message, refused->folder);
      continue;
    }
    if (url.scheme.empty() || url.scheme == "file" || url.scheme == "data") {
      local_.push_back(&fetch);
      return;
    }
    if (loading_.options.offline) {
      fail_candidate(fetch, net::url_for_messages(url.text()) + ": " + std::string(kOfflineProblem));
      continue;
    }
    if (const net::Scheme* scheme = net::find_scheme(url.scheme);
        scheme && scheme->transport == net::TransportKind::cells) {
      if (cells_.begin(fetch, url)) return;
      continue;
    }
    if (!fetch.together.empty()) {
      local_.push_back(&fetch);
      return;
    }
    return network_.begin(fetch);
  }
  ended_.push_back(&fetch);
  loading_.ledger->end(fetch.row, LoadStage::failed, fetch.first_problem);
  fetch.handler->told = fetch.told;
  fetch.handler->missing(fetch.first_problem);
}

void Fetcher::fail_candidate(Fetch& fetch, const std::string& why, const std::string& folder) {
  const bool known = !folder.empty() && !loading_.results.refuse_folder(folder, fetch.reference);
  if (!fetch.first_problem.empty() || fetch.next <= fetch.optional) return;
  fetch.first_problem = why;
  fetch.told = known;
}

// Local files and data: URLs

bool Fetcher::begin_local(Fetch& fetch, const net::Url& url) {
  Found found;
  found.url = url;
  found.fragment = std::exchange(found.url.fragment, {});
  found.candidate = fetch.next - 1;
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
    // A text inside another text has the same origin. A data: URL from the user may contain anyone's text, so it is
    // untrusted.
    found.origin = fetch.from.is_user() ? net::Origin{"data:", net::AddressSpace::global} : fetch.from;
  } else if (!fetch.together.empty()) {
    if (!begin_together(fetch, url, found)) return false;
  } else {
    found.local = true;
    const std::string name = fetch.given_path.empty() ? net::path_of_url(url) : fetch.given_path;
    LocalFile file = open_local_file(url, policy_, fetch.from, fetch.given_path, [&](std::span<const std::byte> first) {
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
  received_ += size;
  fetch.received = size;
  loading_.ledger->receive(fetch.row, size, size);
  fetch.rest = {};
  return true;
}

// Reads all files of `together` at once for the first candidate. Returns false if `url` could not be read.
bool Fetcher::begin_together(Fetch& fetch, const net::Url& url, Found& found) {
  if (!ahead_) {
    ahead_ = served_files();
    std::vector<net::Url> allowed;
    for (const net::Url& one : fetch.together)
      if (!policy_.refuse(fetch.from, one)) allowed.push_back(net::canonical_url(one).value_or(one));
    ahead_->read_ahead(allowed, fetch.from);
  }
  const ServedFiles::Ahead* const known = ahead_->find_ahead(url);
  const auto* const bytes = known ? std::get_if<SharedBytes>(&known->result) : nullptr;
  if (!bytes || !known->head) {
    const auto* const none = known ? std::get_if<NoFile>(&known->result) : nullptr;
    const auto* const problem = known ? std::get_if<std::string>(&known->result) : nullptr;
    fail_candidate(fetch, none ? none->why : problem ? *problem : net::url_for_messages(url.text()) + ": not read");
    return false;
  }
  fetch.data.assign(bytes->bytes.begin(), bytes->bytes.end());
  fetch.rest = fetch.data;
  found.url = net::parse_url(known->head->url);
  found.path = net::url_for_messages(known->head->url);
  found.origin = known->head->origin();
  return true;
}

void Fetcher::local_step() {
  Fetch& fetch = *local_.front();
  if (fetch.stage == Fetch::Stage::seeking) {
    const net::Url url = fetch.candidates[fetch.next - 1];
    if (!begin_local(fetch, url)) {
      local_.pop_front();
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
  local_.pop_front();
  if (fetch.file && loading_.options.component.growing) fetch.file->tolerate_writes();
  finish(fetch, fetch.file ? fetch.file->changed() : std::nullopt);
}

// Handling of received bytes

// Calls `take`, and notes in the ledger whether something visible changed.
void Fetcher::watch_change(const Fetch& fetch, const std::function<void()>& take) {
  LoadResults& results = loading_.results;
  const bool before = results.changed();
  results.set_changed(false);
  take();
  if (results.changed()) loading_.ledger->show(fetch.row);
  results.set_changed(results.changed() || before);
}

void Fetcher::begin_taking(Fetch& fetch, const Found& found) {
  fetch.stage = fetch.handler->begin(found) ? Fetch::Stage::receiving : Fetch::Stage::refused;
}

void Fetcher::deliver(Fetch& fetch, std::span<const std::byte> bytes) {
  if (fetch.max_bytes != Fetch::kNoLimit && bytes.size() > fetch.max_bytes - fetch.received)
    bytes = bytes.first(static_cast<std::size_t>(fetch.max_bytes - fetch.received));
  fetch.received += bytes.size();
  received_ += bytes.size();
  fetch.handler->cut = fetch.cut;
  loading_.ledger->receive(fetch.row, bytes.size(), fetch.total);
  LoadResults& results = loading_.results;
  const std::size_t streams_before = results.feeds().size();
  watch_change(fetch, [&] {
    if (!bytes.empty()) fetch.handler->receive(bytes);
  });
  if (results.feeds().size() > streams_before) loading_.ledger->follow(fetch.row, results.feeds().back().get(), false);
  if (fetch.total && *fetch.total > 0)
    fetch.handler->tell_progress(static_cast<double>(std::min(fetch.received, *fetch.total)) /
                                 static_cast<double>(*fetch.total));
}

void Fetcher::finish(Fetch& fetch, const std::optional<std::string>& problem) {
  ended_.push_back(&fetch);
  fetch.handler->cut = fetch.cut;
  if (fetch.stage == Fetch::Stage::refused)
    return loading_.ledger->end(fetch.row, LoadStage::failed, "its format is not usable here");
  watch_change(fetch, [&] { fetch.handler->end(problem); });
  if (const auto useless = fetch.handler->wants_next()) {
    ended_.pop_back();
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
  if (!problem && fetch.handler->has_more()) {
    ended_.pop_back();
    fetch.stage = Fetch::Stage::refining;
    refining_.push_back(&fetch);
    return;
  }
  count_parts(fetch);
  loading_.ledger->end(fetch.row, problem ? LoadStage::failed : LoadStage::whole, problem.value_or(""));
  if (!problem) fetch.handler->tell_progress(1);
}

// Counts the received parts of a fetch that ends. Parts that views receive later are not counted.
void Fetcher::count_parts(Fetch& fetch) {
  if (fetch.parts) received_ += *std::exchange(fetch.parts, nullptr);
}

void Fetcher::refine_step() {
  Fetch& fetch = *refining_.front();
  watch_change(fetch, [&] { fetch.handler->read_more(); });
  if (fetch.handler->has_more()) return;
  refining_.pop_front();
  ended_.push_back(&fetch);
  count_parts(fetch);
  loading_.ledger->end(fetch.row, LoadStage::whole);
  fetch.handler->tell_progress(1);
}

}  // namespace gs::app
