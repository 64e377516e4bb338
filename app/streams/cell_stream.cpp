#include "app/streams/cell_stream.h"

#include "app/streams/cell_regions.h"
#include "net/base/schemes.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

constexpr std::uint16_t kCellsPort = 6635;  // UDP port of MPLS in UDP (RFC 7510)
constexpr std::uint64_t kAnyRate = 1'000'000'000;  // bits per second; servers reduce it to their limit
constexpr std::size_t kAtOnce = std::size_t{4} << 20;  // max number of bytes to handle before the time is checked
constexpr std::size_t kMaxEarly = std::size_t{64} << 20;
constexpr std::size_t kSlot = 0;

}  // namespace

CellStream::CellStream(const net::Url& url, const CellStreamOptions& options, Sink sink, std::function<void()> wake)
    : name_(net::url_for_messages(url.text())), sink_(std::move(sink)), rate_(options.rate) {
  const auto place = net::host_and_port(url.authority);
  if (!place) {
    problem_ = name_ + ": expected cells://HOST:PORT/PATH";
    return;
  }
  net::CellClientOptions client;
  client.rate = options.rate > 0 ? options.rate : kAnyRate;
  client.loss = options.loss;
  client.loss_seed = options.loss_seed;
  client.reach = options.reach;
  auto started = net::CellClientDriver::start(client, place->host, place->port.value_or(kCellsPort), std::move(wake));
  if (auto* error = std::get_if<net::UdpError>(&started)) {
    problem_ = name_ + ": " + error->message;
    return;
  }
  driver_ = std::move(std::get<std::unique_ptr<net::CellClientDriver>>(started));
  want(url, options);
}

CellStream::CellStream(const net::Url& url, const CellStreamOptions& options, Sink sink,
                       std::unique_ptr<net::CellConnection> connection)
    : name_(net::url_for_messages(url.text())),
      sink_(std::move(sink)),
      driver_(std::move(connection)),
      rate_(options.rate) {
  want(url, options);
}

void CellStream::want(const net::Url& url, const CellStreamOptions& options) {
  wish_.path = url.path.empty() ? "/" : url.path;
  wish_.streams = 1U << 0;  // not the directory
  wish_.budget = options.budget;
  wish_.repair = options.repair;
  driver_->want(kSlot, wish_);
}

bool CellStream::follow_wishes(std::shared_ptr<StreamFeed> feed, std::span<const std::byte> base) {
  if (places_ == 0 || !driver_ || !CellWishes::suits(*feed, base)) return false;
  feed_ = std::move(feed);
  wishes_.emplace(feed_, base, places_);
  wish_.streams = 0;
  wish_.repair = false;
  driver_->want(kSlot, wish_);
  return true;
}

// Tells the server what views want.
void CellStream::prefer() {
  if (wishes_) {
    if (!wishes_->update()) return;
    driver_->forget(kSlot, wishes_->take_again());
    driver_->prefer(kSlot, {}, wishes_->names());
  } else if (std::vector<qnv::LodView> views; feed_ && feed_->take_views(views)) {
    driver_->prefer(kSlot, regions_of(views, feed_->box()), {});
  }
}

bool CellStream::step() {
  if (over_) return false;
  if (!driver_) {
    end(problem_);
    return true;
  }
  prefer();
  follow_weight();
  bool any = false;
  for (net::CellEvent& event : driver_->poll(kAtOnce)) {
    if (over_) break;
    take(event);
    any = true;
  }
  if (any && !over_) prefer();
  return any;
}

// Multiplies the requested rate by the weight of the feed.
void CellStream::follow_weight() {
  if (!feed_ || feed_->weight() == weight_) return;
  if (rate_ == 0) rate_ = static_cast<std::uint64_t>(driver_->statistics().granted);
  if (rate_ == 0) return;  // no rate was granted yet
  weight_ = feed_->weight();
  driver_->set_rate(std::max<std::uint64_t>(1, static_cast<std::uint64_t>(static_cast<double>(rate_) * weight_)));
}

void CellStream::set_rate(std::uint64_t rate) {
  rate_ = rate > 0 ? rate : kAnyRate;
  if (driver_)
    driver_->set_rate(std::max<std::uint64_t>(1, static_cast<std::uint64_t>(static_cast<double>(rate_) * weight_)));
}

void CellStream::take(net::CellEvent& event) {
  using Kind = net::CellEvent::Kind;
  if (event.kind == Kind::granted) {
    // Contact was lost and is back. The server may have a new version of the file.
    if (version_ && *version_ != event.version)
      return end(name_ +
                 ": the file changed on the server during the transfer; the earlier version is shown; reload to get "
                 "the new one");
    version_ = event.version;
    answered_ = true;
    places_ = event.chunks.size() > kPlacesStream ? event.chunks[kPlacesStream] : 0;
    if (!std::exchange(granted_, true)) sink_.granted();
  } else if (event.kind == Kind::base) {
    if (std::exchange(base_, true)) return;
    sink_.base(std::move(event.bytes));
    for (net::CellEvent& early : std::exchange(early_, {})) take_piece(early);
  } else if (event.kind == Kind::piece && !base_) {
    // Pieces cannot be decoded without the base. Keep them until it is received.
    early_bytes_ += event.bytes.size() + sizeof event;
    if (early_bytes_ <= kMaxEarly) early_.push_back(std::move(event));
  } else if (event.kind == Kind::piece) {
    take_piece(event);
  } else if (wishes_ && (event.kind == Kind::ended || event.kind == Kind::complete)) {
    return;  // views may want more
  } else if (event.kind == Kind::ended) {
    missing_ = true;  // unless `complete` follows
    sink_.ended(std::nullopt);
  } else if (event.kind == Kind::complete) {
    missing_ = false;
    end(std::nullopt);
  } else if (event.kind == Kind::refused || event.kind == Kind::failed) {
    answered_ = answered_ || event.kind == Kind::refused;
    end(name_ + ": " + event.text);
  }
}

void CellStream::take_piece(net::CellEvent& event) {
  sink_.piece(event);
  if (!wishes_ || over_) return;
  if (const std::string problem = wishes_->take(event.name, std::move(event.bytes)); !problem.empty())
    end(name_ + ": " + problem);
  else if (!feed_->takes_bytes() && wishes_->complete())
    end(std::nullopt);
}

void CellStream::end(const std::optional<std::string>& problem) {
  over_ = true;
  if (driver_) last_ = driver_->statistics();
  driver_.reset();
  sink_.ended(problem);
}

net::CellClientStatistics CellStream::statistics() const { return driver_ ? driver_->statistics() : last_; }

}  // namespace gs::app
