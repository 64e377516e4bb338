#include "app/loading/fetch/cell_transfers.h"

#include "app/loading/fetch/loading.h"

#include <algorithm>
#include <utility>

// Resources that servers send as cells.
namespace gs::app {
namespace {

void add(net::CellClientStatistics& sum, const net::CellClientStatistics& more) {
  sum.datagrams += more.datagrams;
  sum.lost += more.lost;
  sum.foreign += more.foreign;
  sum.refused_for_space += more.refused_for_space;
  sum.damaged_pdus += more.damaged_pdus;
  sum.bytes += more.bytes;
  sum.parity += more.parity;
  sum.rebuilt += more.rebuilt;
  sum.loss_event_rate = std::max(sum.loss_event_rate, more.loss_event_rate);
  sum.round_trip = std::max(sum.round_trip, more.round_trip);
  sum.granted += more.granted;
  sum.server_rate += more.server_rate;
}

// Limits of requests to silent servers, because a hostile text could name any host. Each silent server gets 16
// greetings of 256 bytes.
constexpr std::size_t kMaxUnanswered = 4;      // concurrent requests without an answer
constexpr std::size_t kMaxSilentServers = 16;  // per world

}  // namespace

struct CellTransfers::Cells {
  std::unique_ptr<CellStream> stream;
  std::string server;
  Fetch* fetch = nullptr;            // fetch that waits for the resource; null if none
  std::shared_ptr<StreamFeed> feed;  // feed for the views that request the rest, or null
  std::uint64_t row = 0;             // row number in the ledger
};

// Begins to read a resource as cells. Returns false if the text may not request it.
bool CellTransfers::begin(Fetch& fetch, const net::Url& url) {
  if (fetch.from.is_user()) {
    open(fetch, url);
    return true;
  }
  if (silent_servers_.contains(url.authority) || silent_servers_.size() >= kMaxSilentServers) {
    loading_.fetcher.fail_candidate(fetch,
                                    net::url_for_messages(url.text()) + (silent_servers_.contains(url.authority)
                                                                             ? ": its server did not answer before"
                                                                             : ": too many servers did not answer"));
    return false;
  }
  waiting_.push_back(&fetch);
  return true;
}

void CellTransfers::open(Fetch& fetch, const net::Url& url) {
  auto one = std::make_shared<Cells>();
  one->fetch = &fetch;
  one->server = url.authority;
  one->row = fetch.row;
  CellStreamOptions settings;
  settings.rate = loading_.options.rate;
  settings.loss = loading_.options.loss;
  settings.loss_seed = loading_.options.loss_seed;
  settings.reach = fetch.from.reach();
  if (fetch.max_bytes != Fetch::kNoLimit)
    settings.budget = fetch.max_bytes;
  else
    settings.repair = loading_.options.by_view;
  CellStream::Sink sink;
  Fetcher& fetcher = loading_.fetcher;
  Cells* const at = one.get();
  sink.granted = [&fetcher, at, url] {
    Found found;
    found.url = url;
    found.fragment = std::exchange(found.url.fragment, {});
    found.url.has_fragment = false;
    found.path = net::url_for_messages(url.text());
    found.origin = {found.url.text(), net::AddressSpace::global};
    if (!at->fetch) return;
    found.candidate = at->fetch->next - 1;
    fetcher.begin_taking(*at->fetch, found);
    if (at->fetch->stage == Fetch::Stage::refused) fetcher.finish(*std::exchange(at->fetch, nullptr), std::nullopt);
  };
  sink.base = [this, &fetcher, at](const std::vector<std::byte>& bytes) {
    if (!at->fetch) return;
    fetcher.deliver(*at->fetch, bytes);
    const bool whole = at->fetch->max_bytes == Fetch::kNoLimit;
    if (!loading_.options.by_view && !(loading_.options.large_by_view && whole)) return;
    const std::shared_ptr<StreamFeed> feed = at->fetch->handler->feed();
    if (!feed) return;
    const bool views_choose = loading_.options.by_view || feed->takes_bytes();
    if (!whole || !views_choose || !at->stream->follow_wishes(feed, bytes)) {
      if (!loading_.options.by_view) return;
      at->stream->follow(feed);
    }
    if (!feed->takes_bytes()) return;
    at->feed = feed;
    loading_.ledger->follow(at->row, at->feed.get(), true);
    at->fetch->handler->leave_to_feed();
    fetcher.leave_to_views(*std::exchange(at->fetch, nullptr));
  };
  sink.piece = [this, &fetcher, at](const net::CellEvent& event) {
    loading_.ledger->receive(at->row, event.bytes.size(), {});
    if (at->feed) {
      fetcher.count_received(event.bytes.size());
      if (!at->stream->by_wishes()) at->feed->add_loose(event.name.chunk, event.bytes);
      fetcher.network().note_growth();
    } else if (at->fetch && event.bytes.size() <= at->fetch->max_bytes - at->fetch->received) {
      fetcher.count_received(event.bytes.size());
      at->fetch->received += event.bytes.size();
      at->fetch->handler->receive_piece(event);
    }
  };
  sink.ended = [this, &fetcher, at](const std::optional<std::string>& problem) {
    if (at->feed && problem) at->feed->fail("finer vectors cannot be read: " + *problem);
    if (at->feed) loading_.ledger->end(at->row, problem ? LoadStage::failed : LoadStage::whole, problem.value_or(""));
    if (!at->fetch) return;
    if (!at->stream->answered()) silent_servers_.insert(at->server);
    Fetch& ending = *std::exchange(at->fetch, nullptr);
    if (ending.stage != Fetch::Stage::seeking) return fetcher.finish(ending, problem);
    fetcher.fail_candidate(ending, problem.value_or(""));
    fetcher.begin_next_candidate(ending);
  };
  one->stream =
      std::make_unique<CellStream>(url, settings, std::move(sink), [waker = loading_.waker] { waker->wake(); });
  cells_.push_back(std::move(one));
}

bool CellTransfers::step() {
  bool any = false;
  const auto unanswered = [this] {
    return std::count_if(cells_.begin(), cells_.end(),
                         [](const auto& one) { return !one->stream->over() && !one->stream->answered(); });
  };
  while (!waiting_.empty() && unanswered() < static_cast<std::ptrdiff_t>(kMaxUnanswered)) {
    Fetch& next = *waiting_.front();
    waiting_.pop_front();
    const net::Url url = next.candidates[next.next - 1];
    if (!silent_servers_.contains(url.authority))
      open(next, url);
    else if (!begin(next, url))
      loading_.fetcher.begin_next_candidate(next);
    any = true;
  }
  // Received data may append streams to `cells`.
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const std::shared_ptr<Cells> one = cells_[i];
    if (!one->stream->step()) continue;
    any = true;
    const net::CellClientStatistics counted = one->stream->statistics();
    loading_.ledger->count_cells(one->row, {counted.datagrams, counted.lost, counted.granted, counted.server_rate,
                                            counted.loss_event_rate, one->stream->missing()});
  }
  std::erase_if(cells_, [this](const auto& one) {
    const bool over = one->stream->over() || (!one->fetch && !one->feed);
    if (over) add(ended_, one->stream->statistics());
    return over;
  });
  return any;
}

bool CellTransfers::streams_rest() const {
  return std::ranges::all_of(cells_, [](const auto& one) { return !one->feed || one->stream->rests(); });
}

void CellTransfers::stop(const Fetch& fetch) {
  std::erase(waiting_, &fetch);
  for (const auto& one : cells_)
    if (one->fetch == &fetch) one->fetch = nullptr;
}

// Applies the bandwidth limit to all cell streams.
void CellTransfers::set_rate() {
  for (const auto& one : cells_) one->stream->set_rate(loading_.options.rate);
}

void CellTransfers::cancel_stream(std::uint64_t row) {
  for (const auto& one : cells_)
    if (one->row == row && !one->fetch && one->feed) {
      one->feed = nullptr;
      loading_.ledger->end(row, LoadStage::cancelled);
    }
}

net::CellClientStatistics CellTransfers::statistics() const {
  net::CellClientStatistics sum = ended_;
  for (const auto& one : cells_) add(sum, one->stream->statistics());
  return sum;
}

}  // namespace gs::app
