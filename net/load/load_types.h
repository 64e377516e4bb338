#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "net/base/range_set.h"
#include "net/base/reference_policy.h"
#include "net/base/schemes.h"
#include "net/http/http_headers.h"

namespace gs::net {

class Transport;

/// Time that never decreases, for time-outs and delays.
using TimePoint = std::chrono::steady_clock::time_point;
using Milliseconds = std::chrono::milliseconds;

/// Identifier of a request, unique in its loader. 0 means none.
struct RequestId {
  std::uint64_t value = 0;
  friend auto operator<=>(const RequestId&, const RequestId&) = default;
};

enum class CacheUse {
  normal,      // as in RFC 9111
  reload,      // ask the server; store the response
  never_store  // neither read nor write
};

/// Request to the loader.
struct Request {
  std::string url;  // absolute; a fragment is not sent
  // Bytes to load, at most LoaderOptions::max_ranges ranges; empty means the whole resource.
  std::vector<ByteRange> ranges;
  int priority = 0;                                  // higher first
  std::uint32_t viewport = 0;                        // requesting viewport; viewports with equal priorities take turns
  std::uint64_t max_bytes = std::uint64_t{4} << 30;  // maximum bytes, also of decompressed data
  std::string accept;                                // media types, as in the header Accept; empty means any
  Origin from;                                       // origin of the document that contains the reference
  Validator validator;                               // if not empty, only bytes of this version are used
  CacheUse cache = CacheUse::normal;
};

enum class LoadErrorKind {
  bad_request,   // invalid URL or ranges
  forbidden,     // not allowed for this document: by its URL, the address of its host, or a redirect
  unsupported,   // scheme without transport
  not_found,     // no such file, or status 404 or 410
  http_status,   // other status that reports an error
  unreachable,   // no connection
  timed_out,     // no connection, no response, or no more bytes in time
  broken,        // the connection ended early
  bad_response,  // against the protocol
  insecure,      // TLS: the server cannot prove its identity
  too_many_redirects,
  too_large,  // more bytes than the request allows
  changed,    // the resource changed while it was read
  unreadable  // file that cannot be read
};

/// Reason why a request failed. The message names the URL (without password), the failure and the expectation.
struct LoadError {
  LoadErrorKind kind = LoadErrorKind::broken;
  std::string message;
  int http_status = 0;
};

/// First event of a request: description of the resource.
struct LoadHead {
  std::string url;                            // after redirects
  std::optional<std::uint64_t> total;         // bytes of the whole resource
  std::string content_type;                   // as received; empty if the transport knows none
  Validator validator;                        // version of all data until the next restart
  bool accepts_ranges = false;                // ranges can be read without reading the bytes before them
  bool from_cache = false;                    // the server was not asked, or confirmed the cached version
  AddressSpace space = AddressSpace::global;  // of the host that sent it

  /// Returns the origin of the received document.
  [[nodiscard]] Origin origin() const { return {url, space}; }
};
/// Bytes; each requested byte is delivered once. The bytes of one range are in order, and all bytes are if the server
/// does not support ranges.
struct LoadData {
  std::uint64_t offset = 0;  // of the first byte in the resource
  std::vector<std::byte> bytes;
};
/// Last event: everything requested was delivered.
struct LoadDone {};
/// The resource has changed, or a broken transfer cannot be resumed. All earlier data are invalid; a new head follows.
struct LoadRestarted {};

/// Event of a request: a head, data, and success or error at the end. Nothing follows the end or a cancellation.
struct LoadEvent {
  RequestId id;
  std::variant<LoadHead, LoadData, LoadDone, LoadRestarted, LoadError> what;
};

/// Limits, time-outs and environment of a loader.
struct LoaderOptions {
  // Memory: received bytes that were not polled. Beyond it, transfers wait; each may exceed it by a block.
  std::size_t max_queued_bytes = std::size_t{8} << 20;
  std::size_t max_queued_bytes_per_request = std::size_t{4} << 20;
  std::size_t max_header_bytes = std::size_t{64} << 10;
  std::size_t max_ranges = 4096;
  // Concurrent transfers. A few more may be paused while more urgent ones run.
  unsigned max_transfers = 16;
  unsigned max_transfers_per_host = 6;
  std::uint64_t bytes_per_second = 0;  // total of all HTTP and FTP transfers; 0 means unlimited
  std::uint64_t join_gap = 4096;       // ranges with smaller gaps are requested as one
  // Time-outs and retries.
  unsigned max_redirects = 10;
  unsigned max_retries = 3;    // retries without progress between them
  unsigned max_attempts = 30;  // transfers of one range, whatever their progress
  unsigned max_restarts = 3;
  Milliseconds connect_timeout{10'000};
  Milliseconds head_timeout{30'000};   // from the start of a transfer to the end of the headers
  Milliseconds stall_timeout{20'000};  // without a byte of the body
  Milliseconds retry_delay{250};       // doubled each time, then multiplied by a random factor between 0.5 and 1
  Milliseconds max_retry_delay{8'000};
  Milliseconds max_retry_after{15'000};  // if a server asks for a longer delay, the request fails
  // Cache. No cache if the folder is empty.
  std::string cache_folder;
  std::uint64_t cache_bytes = std::uint64_t{2} << 30;
  std::size_t cache_entries = 4096;
  // Allowed references.
  ReferencePolicy policy;
  AddressSpaceOf space_of = address_space_of;
  // Environment.
  std::function<void()> wake;                  // called from the loader's threads when poll() has new events
  std::function<std::uint64_t()> random;       // 64 random bits; called from the network thread only
  std::function<std::int64_t()> unix_seconds;  // for the cache; called from the network thread only
  std::string user_agent = "GhostSpace";
  std::string ca_file;                 // certificates to trust instead of the system's
  bool proxy_from_environment = true;  // http_proxy, https_proxy, no_proxy
  // Makes the transport of memory: URLs on the network thread; null means that the scheme is not supported.
  std::function<std::unique_ptr<Transport>()> memory;
};

}  // namespace gs::net
