#include "app/loading/fetch/network_transfers.h"

#include "app/formats/volume/volume.h"
#include "app/loading/fetch/loading.h"
#include "app/loading/fetch/partial_file.h"
#include "net/transfer/transport.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <variant>

// Events of the loader for network resources.
namespace gs::app {
namespace {

constexpr std::uint64_t kWorthChoosing = std::uint64_t{1} << 20;  // bytes; shorter streams are read as a whole

// Converts bits per second to bytes per second. Rounds up, because a result of 0 means unlimited.
std::uint64_t byte_rate_of(std::uint64_t bits) { return bits / 8 + (bits % 8 > 0 ? 1 : 0); }

}  // namespace

net::LoaderOptions NetworkTransfers::loader_options() const {
  net::LoaderOptions settings;
  settings.cache_folder = loading_.options.cache_folder;
  settings.memory = loading_.options.memory;
  settings.policy = loading_.fetcher.policy();
  settings.bytes_per_second = byte_rate_of(loading_.options.rate);
  settings.remote_program = loading_.options.remote_program;
  settings.report = [notices = notices_, waker = loading_.waker](const std::string& message) {
    notices->add(message);
    waker->wake();
  };
  settings.wake = [waker = loading_.waker] { waker->wake(); };
  return settings;
}

net::Loader& NetworkTransfers::loader() {
  if (!loader_) loader_ = net::Loader::create(loader_options());
  return *loader_;
}

void NetworkTransfers::set_rate() {
  if (loader_) loader_->set_rate(byte_rate_of(loading_.options.rate));
}

void NetworkTransfers::begin(Fetch& fetch) {
  std::vector<net::ByteRange> ranges;
  if (fetch.max_bytes != Fetch::kNoLimit) ranges = {{0, fetch.max_bytes}};
  const std::string& path = fetch.candidates[fetch.next - 1].path;
  const bool by_view = loading_.options.by_view || loading_.options.large_by_view || loading_.options.one_step;
  // A growing file has another version at each request, so it is read as a whole.
  const bool by_parts = (loading_.options.by_view || loading_.options.large_by_view) &&
                        !loading_.options.component.growing && may_read_by_parts(path);
  const bool is_long = ranges.empty() && ((by_view && path.ends_with(".qnv")) || by_parts);
  fetch.part = is_long ? Fetch::Part::front : Fetch::Part::all;
  if (is_long) ranges = {{0, kFrontBytes}};
  ask(fetch, std::move(ranges));
}

void NetworkTransfers::cancel(Fetch& fetch) {
  cancel_stream(fetch.row);
  if (by_request_.contains(fetch.request.value)) loader_->cancel(fetch.request);
  end_request(fetch);
}

void NetworkTransfers::cancel_all() {
  for (const auto& stream : streams_)
    if (stream->has_fetch()) stream->cancel();
  for (const auto& [id, fetch] : by_request_) loader_->cancel(fetch->request);
  by_request_.clear();
}

void NetworkTransfers::end_request(Fetch& fetch) {
  by_request_.erase(fetch.request.value);
  fetch.request = {};
}

void NetworkTransfers::ask(Fetch& fetch, std::vector<net::ByteRange> ranges) {
  net::Request request;
  request.url = without_fragment(fetch.candidates[fetch.next - 1]);
  request.priority = fetch.priority;
  request.from = fetch.from;
  request.max_bytes = std::min(fetch.max_bytes, request.max_bytes);
  request.ranges = std::move(ranges);
  request.validator = fetch.validator;
  if (fetch.refresh) request.cache = net::CacheUse::reload;
  fetch.request = loader().request(std::move(request));
  by_request_[fetch.request.value] = &fetch;
}

bool NetworkTransfers::step() {
  if (!loader_) return false;
  for (std::string& notice : notices_->take())
    loading_.results.report(Severity::warning, loading_.results.file(), {}, std::move(notice));
  std::vector<net::LoadEvent> polled = loader_->poll();
  events_.insert(events_.end(), std::make_move_iterator(polled.begin()), std::make_move_iterator(polled.end()));
  const bool any = !events_.empty() || loader_->queued_bytes() > 0;
  while (!events_.empty()) {
    net::LoadEvent event = std::move(events_.front());
    events_.pop_front();
    const auto known = by_request_.find(event.id.value);
    if (known != by_request_.end()) {
      take(*known->second, event);
      continue;
    }
    for (const auto& stream : streams_)
      if (stream->take(event)) break;
    streams_grew_ = true;
  }
  return any;
}

void NetworkTransfers::take(Fetch& fetch, net::LoadEvent& event) {
  Fetcher& fetcher = loading_.fetcher;
  if (auto* head = std::get_if<net::LoadHead>(&event.what)) {
    fetch.total = head->total;
    fetch.cut = head->total && *head->total > fetch.max_bytes;
    if (fetch.part == Fetch::Part::front && !take_front(fetch, *head)) return;
    Found found;
    found.url = net::parse_url(head->url);
    found.candidate = fetch.next - 1;
    found.fragment = fetch.candidates[found.candidate].fragment;
    found.path = net::url_for_messages(head->url);
    found.origin = head->origin();
    if (fetch.stage == Fetch::Stage::seeking) fetcher.begin_taking(fetch, found);
  } else if (auto* data = std::get_if<net::LoadData>(&event.what)) {
    if (fetch.stage == Fetch::Stage::receiving) fetcher.deliver(fetch, data->bytes);
  } else if (std::holds_alternative<net::LoadDone>(event.what)) {
    end_request(fetch);
    if (fetch.part == Fetch::Part::front && fetch.stage == Fetch::Stage::receiving && fetch.total &&
        fetch.received < *fetch.total)
      return take_rest(fetch);
    return fetcher.finish(fetch, std::nullopt);
  } else if (std::holds_alternative<net::LoadRestarted>(event.what)) {
    if (fetch.received > 0) {
      cancel(fetch);
      return fetcher.finish(
          fetch,
          "the file changed on the server during the transfer; the earlier version is shown; reload to get "
          "the new one");
    }
  } else if (auto* error = std::get_if<net::LoadError>(&event.what)) {
    end_request(fetch);
    if (fetch.stage != Fetch::Stage::seeking) return fetcher.finish(fetch, error->message);
    fetcher.fail_candidate(fetch, error->message);
    return fetcher.begin_next_candidate(fetch);
  }
  if (fetch.stage != Fetch::Stage::refused) return;
  cancel(fetch);
  fetcher.finish(fetch, std::nullopt);
}

void NetworkTransfers::cancel_stream(std::uint64_t row) {
  for (const auto& stream : streams_) stream->cancel_row(row);
}

bool NetworkTransfers::step_streams() {
  bool busy = false;
  for (const auto& stream : streams_) busy = stream->ask_for_more() || busy;
  std::erase_if(streams_, [](const auto& stream) { return stream->over(); });
  return busy;
}

bool NetworkTransfers::streams_rest() const {
  return std::ranges::all_of(streams_, [](const auto& stream) { return stream->rests(); });
}

NetworkTransfers::Nodes NetworkTransfers::wanted() const {
  Nodes nodes;
  for (const auto& [id, fetch] : by_request_)
    if (fetch->node) nodes.insert(fetch->node);
  return nodes;
}

void NetworkTransfers::set_priorities() {
  if (by_request_.empty()) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_priorities_) return;
  next_priorities_ = now + std::chrono::milliseconds(200);
  const Importance importance = importance_(wanted());
  for (const auto& [id, fetch] : by_request_) {
    const auto known = importance.find(fetch->node);
    if (known == importance.end()) continue;
    const int size = static_cast<int>(std::clamp(known->second, 0.0f, 1.0f) * (kUrgencyStep - 1));
    const int priority = fetch->priority / kUrgencyStep * kUrgencyStep + size;
    if (priority == fetch->priority) continue;
    fetch->priority = priority;
    loader_->set_priority(fetch->request, priority);
  }
}

// Requests only the first bytes of a long stream. Returns false if it requests the whole resource instead.
bool NetworkTransfers::take_front(Fetch& fetch, const net::LoadHead& head) {
  fetch.validator = head.validator;
  if (head.accepts_ranges && head.total && *head.total >= kWorthChoosing) return true;
  fetch.part = Fetch::Part::all;
  if (head.total && *head.total <= kFrontBytes) return true;
  cancel(fetch);
  ask(fetch, {});
  return false;
}

// Offers a file of datasets or voxels to its handler by parts. Returns false if the handler needs the file in order.
bool NetworkTransfers::read_parts(Fetch& fetch) {
  const net::Url& url = fetch.candidates[fetch.next - 1];
  if (*fetch.total < PartialFile::kLeastFile || loading_.options.component.growing || !may_read_by_parts(url.path))
    return false;
  const auto counter = std::make_shared<std::atomic<std::uint64_t>>(0);
  PartsOffer offer{{url, fetch.from, fetch.validator, *fetch.total}, loading_.fetcher.served_files(), counter};
  if (fetch.refresh) offer.place.cache = net::CacheUse::reload;
  fetch.parts = counter;
  if (!fetch.handler->take_parts(offer)) {
    fetch.parts.reset();
    return false;
  }
  fetch.total.reset();
  loading_.fetcher.finish(fetch, std::nullopt);
  return true;
}

void NetworkTransfers::take_rest(Fetch& fetch) {
  fetch.part = Fetch::Part::all;
  RangedStream::Place place;
  place.url = without_fragment(fetch.candidates[fetch.next - 1]);
  place.from = fetch.from;
  place.validator = fetch.validator;
  place.front = fetch.received;
  place.total = *fetch.total;
  place.ledger = loading_.ledger;
  place.row = fetch.row;
  std::shared_ptr<StreamFeed> feed = fetch.handler->feed();
  if (!feed && read_parts(fetch)) return;
  if (feed) place.directory = feed->directory();
  const bool by_view = feed && !feed->requests()->in_stream_order() &&
                       (loading_.options.by_view || loading_.options.one_step || feed->takes_bytes());
  if (!by_view || place.directory < place.front || place.directory >= place.total)
    return ask(fetch, {{fetch.received, *fetch.total}});
  RangedStream::Sink sink;
  const bool leaves = feed->takes_bytes();
  if (!leaves) {
    Fetcher& fetcher = loading_.fetcher;
    sink.chunk = [&fetcher, &fetch](std::vector<std::byte> chunk) {
      fetch.received += chunk.size();
      fetcher.count_received(chunk.size());
      net::CellEvent event;
      event.bytes = std::move(chunk);
      fetch.handler->receive_piece(event);
      fetch.handler->tell_progress(static_cast<double>(std::min(fetch.received, *fetch.total)) /
                                   static_cast<double>(*fetch.total));
    };
    sink.end = [&fetcher, &fetch](const std::optional<std::string>& problem) { fetcher.finish(fetch, problem); };
    sink.read_on = [this, &fetch] { ask(fetch, {{fetch.received, *fetch.total}}); };
  }
  streams_.push_back(std::make_shared<RangedStream>(loader(), std::move(feed), std::move(place), std::move(sink)));
  if (!leaves) return;
  fetch.handler->leave_to_feed();
  loading_.fetcher.leave_to_views(fetch);
}

// Reads a resource that an importer waits for. Events of other requests are queued meanwhile.
BytesResult NetworkTransfers::read_now(const net::Url& url, const net::Origin& from) {
  const WantedPart wanted{url, std::nullopt};
  FileResult result = std::move(read_all_now({&wanted, 1}, from).front());
  if (auto* const bytes = std::get_if<SharedBytes>(&result)) return std::move(*bytes);
  if (auto* const problem = std::get_if<std::string>(&result)) return std::move(*problem);
  return std::move(std::get<NoFile>(result).why);
}

std::vector<FileResult> NetworkTransfers::read_all_now(std::span<const WantedPart> wanted, const net::Origin& from) {
  ReadingHooks hooks;
  hooks.stopped = [this] { return loading_.limit.over(); };
  hooks.other = [this](net::LoadEvent event) { events_.push_back(std::move(event)); };
  hooks.wait = [this] { loading_.waker->wait(kLongestWait); };
  hooks.received = [this](std::uint64_t bytes) { loading_.fetcher.count_received(bytes); };
  return read_resources(loader(), wanted, from, loading_.budget, hooks);
}

}  // namespace gs::app
