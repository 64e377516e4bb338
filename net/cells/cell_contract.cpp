#include "net/cells/cell_contract.h"

#include "net/base/network_bytes.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace gs::net {
namespace {

constexpr std::uint8_t kContractVersion = 1;
constexpr unsigned kRunShift = 4;  // a wish has the stream in the low bits, and the further chunks above
static_assert(kMaxStreams == std::size_t{1} << kRunShift && ChunkRun::kMost == std::size_t{1} << (8 - kRunShift));
constexpr std::size_t kMinReport = 64;  // bytes; longer than a ByeMessage without text

void put_text(NetworkWriter& out, std::string_view text, std::size_t most) {
  text = text.substr(0, most);
  out.integer(static_cast<std::uint16_t>(text.size()));
  out.bytes(std::as_bytes(std::span(text.data(), text.size())));
}

std::string text_from(NetworkReader& in) {
  const auto bytes = in.bytes(in.integer<std::uint16_t>());
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void put(NetworkWriter& out, const HelloMessage& message) { out.integer(message.nonce); }
void put(NetworkWriter& out, const CookieMessage& message) {
  out.integer(message.nonce);
  out.integer(message.time);
  out.integer(message.tag);
}
void put(NetworkWriter& out, const RequestMessage& message) {
  put(out, message.cookie);
  out.integer(message.number);
  out.integer(message.slot);
  out.integer(message.weight);
  out.integer(message.cells);
  out.integer(message.streams);
  out.integer(message.rate);
  out.integer(message.budget);
  put_text(out, message.path, kMaxPath);
}
void put(NetworkWriter& out, const GrantMessage& message) {
  out.integer(message.session);
  out.integer(message.number);
  out.integer(message.slot);
  out.integer(message.rate);
  out.integer(message.version);
  out.integer(message.base_crc);
  out.integer(static_cast<std::uint8_t>(message.delay_aware));
  out.integer(message.base.bytes);
  out.integer(message.base.symbol);
  out.integer(message.base.source);
  const std::size_t count = std::min(message.streams.size(), kMaxStreams);
  out.integer(static_cast<std::uint8_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    out.integer(static_cast<std::uint8_t>(message.streams[i].records));
    out.integer(message.streams[i].chunks);
  }
}
void put(NetworkWriter& out, const RefuseMessage& message) {
  out.integer(message.nonce);
  out.integer(message.number);
  out.integer(message.slot);
  out.integer(static_cast<std::uint8_t>(message.why));
  put_text(out, message.text, kMaxText);
}
void put(NetworkWriter& out, const SlotReport& report) {
  out.integer(report.slot);
  out.integer(report.number);
  out.integer(static_cast<std::uint8_t>(report.base_done));
  const std::size_t regions = std::min(report.regions.size(), kMaxRegions);
  out.integer(static_cast<std::uint8_t>(regions));
  for (std::size_t i = 0; i < regions; ++i) {
    for (const std::uint16_t corner : report.regions[i].box) out.integer(corner);
    out.integer(report.regions[i].weight);
  }
  const std::size_t wishes = std::min(report.wishes.size(), kMaxWishes);
  out.integer(static_cast<std::uint8_t>(wishes));
  for (std::size_t i = 0; i < wishes; ++i) {
    const ChunkRun& run = report.wishes[i];
    const std::size_t more = std::clamp<std::size_t>(run.count, 1, ChunkRun::kMost) - 1;
    out.integer(static_cast<std::uint8_t>(run.first.stream | more << kRunShift));
    out.integer(run.first.chunk);
  }
}
void put(NetworkWriter& out, const ReportMessage& message) {
  out.integer(message.session);
  out.integer(message.number);
  out.integer(message.next);
  out.integer(message.received);
  out.integer(message.lost);
  out.integer(message.loss_rate);
  out.integer(message.receive_rate);
  out.integer(message.echo);
  out.integer(message.held);
  out.integer(message.rate);
  const std::size_t count = std::min(message.slots.size(), kMaxSlots);
  out.integer(static_cast<std::uint8_t>(count));
  for (std::size_t i = 0; i < count; ++i) put(out, message.slots[i]);
}
void put(NetworkWriter& out, const SyncMessage& message) {
  out.integer(message.session);
  out.integer(message.time);
  out.integer(message.next);
  out.integer(message.granted);
  out.integer(message.rate);
  out.integer(message.round_trip);
  const std::size_t count = std::min(message.slots.size(), kMaxSlots);
  out.integer(static_cast<std::uint8_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    out.integer(message.slots[i].slot);
    out.integer(message.slots[i].number);
    out.integer(static_cast<std::uint8_t>(message.slots[i].ended));
    out.integer(message.slots[i].bytes);
  }
}
void put(NetworkWriter& out, const ByeMessage& message) {
  out.integer(message.session);
  put_text(out, message.text, kMaxText);
}

using Parsed = std::optional<ContractMessage>;

CookieMessage cookie_from(NetworkReader& in) {
  CookieMessage message;
  message.nonce = in.integer<std::uint64_t>();
  message.time = in.integer<std::uint32_t>();
  message.tag = in.integer<std::uint64_t>();
  return message;
}

Parsed request_from(NetworkReader& in) {
  RequestMessage message;
  message.cookie = cookie_from(in);
  message.number = in.integer<std::uint32_t>();
  message.slot = in.integer<std::uint8_t>();
  message.weight = in.integer<std::uint8_t>();
  message.cells = in.integer<std::uint8_t>();
  message.streams = in.integer<std::uint32_t>();
  message.rate = in.integer<std::uint64_t>();
  message.budget = in.integer<std::uint64_t>();
  message.path = text_from(in);
  if (message.slot >= kMaxSlots || message.weight == 0 || message.cells < kMinCells || message.cells > kMaxCells ||
      message.path.size() > kMaxPath)
    return std::nullopt;
  return message;
}

Parsed grant_from(NetworkReader& in) {
  GrantMessage message;
  message.session = in.integer<std::uint64_t>();
  message.number = in.integer<std::uint32_t>();
  message.slot = in.integer<std::uint8_t>();
  message.rate = in.integer<std::uint64_t>();
  message.version = in.integer<std::uint32_t>();
  message.base_crc = in.integer<std::uint32_t>();
  message.delay_aware = (in.integer<std::uint8_t>() & 1) != 0;
  message.base.bytes = in.integer<std::uint32_t>();
  message.base.symbol = in.integer<std::uint16_t>();
  message.base.source = in.integer<std::uint8_t>();
  const auto count = in.integer<std::uint8_t>();
  if (message.slot >= kMaxSlots || count > kMaxStreams) return std::nullopt;
  for (std::size_t i = 0; i < count; ++i) {
    StreamGrant stream;
    stream.records = (in.integer<std::uint8_t>() & 1) != 0;
    stream.chunks = in.integer<std::uint32_t>();
    if (stream.chunks > kMaxChunks) return std::nullopt;
    message.streams.push_back(stream);
  }
  // The answer to a request that clears a slot has no base.
  if (message.base.bytes != 0 && !message.base.sound()) return std::nullopt;
  return message;
}

Parsed refuse_from(NetworkReader& in) {
  RefuseMessage message;
  message.nonce = in.integer<std::uint64_t>();
  message.number = in.integer<std::uint32_t>();
  message.slot = in.integer<std::uint8_t>();
  message.why = static_cast<Refusal>(in.integer<std::uint8_t>());
  message.text = text_from(in);
  if (message.slot >= kMaxSlots || message.text.size() > kMaxText) return std::nullopt;
  return message;
}

bool slot_from(NetworkReader& in, SlotReport& report) {
  report.slot = in.integer<std::uint8_t>();
  report.number = in.integer<std::uint32_t>();
  report.base_done = (in.integer<std::uint8_t>() & 1) != 0;
  const auto regions = in.integer<std::uint8_t>();
  if (report.slot >= kMaxSlots || regions > kMaxRegions) return false;
  report.regions.resize(regions);
  for (Region& region : report.regions) {
    for (std::uint16_t& corner : region.box) corner = in.integer<std::uint16_t>();
    region.weight = in.integer<std::uint8_t>();
  }
  const auto wishes = in.integer<std::uint8_t>();
  if (wishes > kMaxWishes) return false;
  report.wishes.resize(wishes);
  for (ChunkRun& run : report.wishes) {
    const auto packed = in.integer<std::uint8_t>();
    run.first.stream = packed & (kMaxStreams - 1);
    run.count = static_cast<std::uint8_t>((packed >> kRunShift) + 1);
    run.first.chunk = in.integer<std::uint32_t>();
  }
  return true;
}

Parsed report_from(NetworkReader& in) {
  ReportMessage message;
  message.session = in.integer<std::uint64_t>();
  message.number = in.integer<std::uint32_t>();
  message.next = in.integer<std::uint64_t>();
  message.received = in.integer<std::uint64_t>();
  message.lost = in.integer<std::uint64_t>();
  message.loss_rate = in.integer<std::uint32_t>();
  message.receive_rate = in.integer<std::uint64_t>();
  message.echo = in.integer<std::uint32_t>();
  message.held = in.integer<std::uint32_t>();
  message.rate = in.integer<std::uint64_t>();
  const auto count = in.integer<std::uint8_t>();
  if (count > kMaxSlots) return std::nullopt;
  message.slots.resize(count);
  for (SlotReport& report : message.slots)
    if (!slot_from(in, report)) return std::nullopt;
  return message;
}

Parsed sync_from(NetworkReader& in) {
  SyncMessage message;
  message.session = in.integer<std::uint64_t>();
  message.time = in.integer<std::uint32_t>();
  message.next = in.integer<std::uint64_t>();
  message.granted = in.integer<std::uint64_t>();
  message.rate = in.integer<std::uint64_t>();
  message.round_trip = in.integer<std::uint32_t>();
  const auto count = in.integer<std::uint8_t>();
  if (count > kMaxSlots) return std::nullopt;
  for (std::size_t i = 0; i < count; ++i) {
    SlotSync& slot = message.slots.emplace_back();
    slot.slot = in.integer<std::uint8_t>();
    slot.number = in.integer<std::uint32_t>();
    slot.ended = (in.integer<std::uint8_t>() & 1) != 0;
    slot.bytes = in.integer<std::uint64_t>();
    if (slot.slot >= kMaxSlots) return std::nullopt;
  }
  return message;
}

Parsed bye_from(NetworkReader& in) {
  ByeMessage message;
  message.session = in.integer<std::uint64_t>();
  message.text = text_from(in);
  if (message.text.size() > kMaxText) return std::nullopt;
  return message;
}

/// Parser of a message. The table's index is the type number of the message and its index in ContractMessage.
using Parse = Parsed (*)(NetworkReader&);
constexpr Parse kParsers[] = {[](NetworkReader& in) -> Parsed { return HelloMessage{in.integer<std::uint64_t>()}; },
                              [](NetworkReader& in) -> Parsed { return cookie_from(in); },
                              request_from,
                              grant_from,
                              refuse_from,
                              report_from,
                              sync_from,
                              bye_from};
static_assert(std::size(kParsers) == std::variant_size_v<ContractMessage>);

}  // namespace

std::vector<std::byte> encode_contract(const ContractMessage& message) {
  std::vector<std::byte> bytes;
  put_associated_channel(bytes, kCellLabel, kContractChannel);
  NetworkWriter out(bytes);
  out.integer(kContractVersion);
  out.integer(static_cast<std::uint8_t>(message.index()));
  std::visit([&](const auto& value) { put(out, value); }, message);
  if (std::holds_alternative<HelloMessage>(message)) bytes.resize(std::max(bytes.size(), kHelloBytes));
  if (std::holds_alternative<ReportMessage>(message)) bytes.resize(std::max(bytes.size(), kMinReport));
  return bytes;
}

std::optional<ContractMessage> decode_contract(std::span<const std::byte> bytes) {
  const auto body = associated_channel(bytes, kCellLabel, kContractChannel);
  if (!body) return std::nullopt;
  NetworkReader in(*body);
  const auto version = in.integer<std::uint8_t>();
  const auto type = in.integer<std::uint8_t>();
  if (!in.good() || version != kContractVersion || type >= std::size(kParsers)) return std::nullopt;
  auto message = kParsers[type](in);
  if (!in.good()) return std::nullopt;
  return message;
}

CookieMessage CookieMaker::make(const Endpoint& client, std::uint64_t nonce, Instant now) const {
  const auto time = static_cast<std::uint32_t>(now.count() / 1000);
  return {nonce, time, tag(client, nonce, time, 'c')};
}

std::optional<Instant> CookieMaker::age(const CookieMessage& cookie, const Endpoint& client, Instant now) const {
  if (cookie.tag != tag(client, cookie.nonce, cookie.time, 'c')) return std::nullopt;
  const std::uint32_t age = static_cast<std::uint32_t>(now.count() / 1000) - cookie.time;
  return Instant(std::int64_t{age} * 1000);
}

std::uint64_t CookieMaker::session(const Endpoint& client, std::uint64_t nonce) const {
  return tag(client, nonce, 0, 's');
}

std::uint64_t CookieMaker::tag(const Endpoint& client, std::uint64_t nonce, std::uint32_t time, char use) const {
  std::vector<std::byte> bytes;
  NetworkWriter out(bytes);
  out.bytes(std::as_bytes(std::span(client.address)));
  out.integer(client.port);
  out.integer(nonce);
  out.integer(time);
  out.integer(static_cast<std::uint8_t>(use));
  return siphash(secret_, bytes);
}

}  // namespace gs::net
