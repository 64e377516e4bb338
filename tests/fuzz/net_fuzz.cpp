// Fuzzes data from servers and documents: URLs, headers, cache records, cells.
#include "net/base/schemes.h"
#include "net/base/url.h"
#include "net/cells/cell_framing.h"
#include "net/http/cache_entry.h"
#include "net/transfer/transport.h"
#include "net/serve/access_log.h"
#include "net/serve/http_range.h"
#include "tests/fuzz/net_targets.h"

using namespace gs::net;

namespace gs::fuzz {
namespace {

bool has_control(std::string_view text) {
  for (const char c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return true;
  return false;
}

/// Fuzzes URLs. The input has a base and a reference, one per line.
bool run_urls(std::span<const std::byte> bytes) {
  const std::string_view text = text_of(bytes);
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view first = text.substr(0, end), second = text.substr(std::min(end + 1, text.size()));
  const Url base = parse_url(first), reference = parse_url(tidy_url(second));
  const Url whole = resolve(base, reference);
  // The text of a URL must parse to an equal URL, and resolve to itself.
  for (const Url& url : {base, reference, whole}) require(parse_url(url.text()).text() == url.text());
  if (!whole.scheme.empty()) require(resolve(base, whole).text() == resolve(base, resolve(base, whole)).text());
  for (const Url& url : {base, whole}) {
    if (const auto place = host_and_port(url.authority)) require(!place->host.empty() && place->port.value_or(1) != 0);
    const std::string path = path_of_url(url);
    require(path.empty() || url.scheme == "file");
    if (path.starts_with('/')) {
      const std::string plain = path_of_url(url_of_path(path));  // without "/./"; a drive has no leading slash
      require(!plain.starts_with('/') || path_of_url(url_of_path(plain)) == plain);
    }
    require(!has_control(url_for_messages(url.text())));
  }
  return !whole.scheme.empty() && !whole.path.empty();
}

bool run_data_url(std::span<const std::byte> bytes) {
  const auto decoded = decode_data_url(text_of(bytes));
  if (decoded) require(decoded->bytes.size() <= bytes.size());
  return decoded && !decoded->bytes.empty();
}

/// Fuzzes the header lines of an HTTP response.
bool run_http_headers(std::span<const std::byte> bytes) {
  constexpr std::int64_t kNow = 1'700'000'000;
  std::string_view text = text_of(bytes);
  ResponseHead head;
  std::size_t known = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) continue;
    add_header(head, line.substr(0, colon), line.substr(colon + 1), kNow);
    ++known;
    (void)parse_http_date(line.substr(colon + 1));
    if (const auto size = parse_decimal(line.substr(colon + 1))) require(*size > 0 || line.find('0') != line.npos);
  }
  finish_head(head);
  require(freshness(head) >= 0);
  if (head.content_range) {
    const ContentRange& range = *head.content_range;
    require(range.begin.has_value() == range.end.has_value());
    if (range.begin) require(*range.begin < *range.end && *range.end <= range.total.value_or(*range.end));
  }
  require(head.validator.agrees(head.validator));
  return known > 1 && (head.content_length || head.content_range);
}

/// Fuzzes a Range header and conditions, one per line. The first line is the length of the body.
bool run_http_range(std::span<const std::byte> bytes) {
  std::string_view text = text_of(bytes);
  const auto line = [&] {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view one = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return std::string(one);
  };
  const std::uint64_t size = parse_decimal(line()).value_or(1000);
  const auto ranges = parse_ranges(line(), size);
  const auto* some = std::get_if<std::vector<ServedRange>>(&ranges);
  if (some) {
    require(!some->empty() && some->size() <= kMaxServedRanges);
    std::uint64_t all = 0;
    for (const ServedRange& range : *some) {
      require(range.begin < range.end && range.end <= size);
      all += range.end - range.begin;
    }
    require(all <= size);  // no byte is sent twice
  }
  Conditions conditions;
  for (std::string* value : {&conditions.if_match, &conditions.if_none_match, &conditions.if_modified_since,
                             &conditions.if_unmodified_since, &conditions.if_range})
    *value = line();
  (void)evaluate(conditions, "\"tag\"", 1'700'000'000);
  (void)range_counts(conditions, "\"tag\"", 1'700'000'000);
  (void)accepts_gzip(text);
  return some != nullptr;
}

/// Fuzzes records of the disk cache. A record that was read must be written with the same bytes.
bool run_cache_entry(std::span<const std::byte> bytes) {
  const std::vector<std::byte> own(bytes.begin(), bytes.end());
  const auto check = [](std::span<const std::byte> record) {
    const auto entry = read_cache_entry(record);
    if (!entry) return false;
    std::uint64_t end = 0;
    for (const CacheExtent& extent : entry->extents) {
      require(extent.begin >= end && extent.size > 0 && extent.end() > extent.begin);
      end = extent.end();
    }
    (void)entry->present().size();
    const auto again = read_cache_entry(write_cache_entry(*entry));
    require(again && again->key == entry->key && again->extents.size() == entry->extents.size());
    return true;
  };
  // The record ends with a checksum. The target corrects the checksum after a mutation.
  std::vector<std::byte> mended = own;
  if (mended.size() >= 4) {
    const std::uint32_t sum = cache_checksum(std::span(mended).first(mended.size() - 4));
    for (std::size_t i = 0; i < 4; ++i) mended[mended.size() - 4 + i] = static_cast<std::byte>(sum >> (8 * i));
  }
  const bool taken = check(own);
  return check(mended) || taken;
}

/// Fuzzes cells and the reassembly of PDUs. A cell with the highest path identifier stands for a loss.
bool run_cells(std::span<const std::byte> bytes) {
  Reassembler assembler(8);
  std::vector<Pdu> units;
  std::vector<std::byte> datagram = encode_datagram(1, 1, {});
  for (; bytes.size() >= kPackedCell; bytes = bytes.subspan(kPackedCell)) {
    datagram.resize(kDatagramHeader);
    datagram.insert(datagram.end(), bytes.begin(), bytes.begin() + kPackedCell);
    const Cell cell = std::get<CellDatagram>(decode_datagram(datagram)).cells.at(0);
    if (cell.vc.vpi == 0xfff)
      assembler.lost_anywhere(units);
    else
      assembler.push(cell, units);
  }
  assembler.lost_anywhere(units);
  bool whole = false;
  for (const Pdu& unit : units) {
    require(unit.whole ? unit.parts.empty() && unit.bytes.size() <= kMaxPdu : unit.bytes.empty());
    whole = whole || unit.whole;
    std::span<const std::byte> rest;
    if (const auto place = decode_place(unit.bytes, rest)) require(encode_place(*place, rest) == unit.bytes);
  }
  return whole;
}

/// Fuzzes the access log. Each request must give exactly one line.
bool run_log_line(std::span<const std::byte> bytes) {
  AccessRecord record;
  record.method = record.target = record.version = std::string(text_of(bytes));
  const std::string line = log_line(record);
  require(line.ends_with('\n') ? line.find('\n') == line.size() - 1 : line.find('\n') == std::string::npos);
  require(!has_control(line.substr(0, line.find('\n'))));
  return !line.empty();
}

}  // namespace

std::vector<FuzzTarget> fuzz_targets() {
  return {{"urls", run_urls, 512},
          {"data_url", run_data_url, 2048},
          {"http_headers", run_http_headers, 2048},
          {"http_range", run_http_range, 1024},
          {"http_request", run_http_request, 2048},
          {"cache_entry", run_cache_entry, 4096},
          {"log_line", run_log_line, 512},
          {"cells", run_cells, 8192},
          {"cell_datagrams", run_cell_datagrams, 16384},
          {"control_client", run_control_client, 4096},
          {"tunnel", run_tunnel, 4096},
          {"sftp", run_sftp, 4096}};
}

}  // namespace gs::fuzz
