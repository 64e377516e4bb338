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

/// Steady time for time-outs and delays. Never decreases.
using TimePoint = std::chrono::steady_clock::time_point;
using Milliseconds = std::chrono::milliseconds;

/// Identifier of a request, unique in its loader. 0 means none.
struct RequestId {
  std::uint64_t value = 0;
  friend auto operator<=>(const RequestId&, const RequestId&) = default;
};

enum class CacheUse {
  normal,      // use the cache as in RFC 9111
  reload,      // ask the server even if the cached version is fresh; store the response
  never_store  // neither read nor write
};

/// Request to the loader.
struct Request {
  std::string url;  // absolute URL; its fragment is not sent
  // Bytes to load, in at most LoaderOptions::max_ranges ranges. Empty means the whole resource.
  std::vector<ByteRange> ranges;
  int priority = 0;                                  // higher values first
  std::uint32_t viewport = 0;                        // the viewport; with equal priorities, viewports take turns
  std::uint64_t max_bytes = std::uint64_t{4} << 30;  // maximum bytes, also after decompression
  std::string accept;                                // media types for the header Accept; empty means any
  Origin from;                                       // origin of the document with the reference
  Validator validator;                               // if not empty, only this version of the resource is accepted
  CacheUse cache = CacheUse::normal;
  // Requests with one of these are not redirected.
  bool post = false;          // HTTP: sends POST without a body. It may be sent twice if a connection breaks
  std::string authorization;  // HTTP: value of the field Authorization; empty means none
};

enum class LoadErrorKind {
  bad_request,   // the URL or the ranges are invalid
  forbidden,     // the URL, the host's address or a redirect is not allowed for the document
  unsupported,   // no transport handles the scheme
  not_found,     // the file does not exist, or status 404 or 410
  http_status,   // another status that means an error
  unreachable,   // no connection is possible
  timed_out,     // no connection, response or further bytes within the time limit
  broken,        // the connection ended too early
  bad_response,  // the response violates the protocol
  insecure,      // TLS: the server cannot prove its identity
  too_many_redirects,
  too_large,  // more bytes than the request allows
  changed,    // the resource changed during the transfer
  unreadable  // the file cannot be read
};

/// Reason why a request failed. The message names the URL (without password), the failure and what was expected.
struct LoadError {
  LoadErrorKind kind = LoadErrorKind::broken;
  std::string message;
  int http_status = 0;
};

/// First event of a request: describes the resource.
struct LoadHead {
  std::string url;                            // URL after redirects
  std::optional<std::uint64_t> total;         // bytes of the complete resource
  std::string content_type;                   // as received; empty if the transport has no content type
  Validator validator;                        // version of all data until a restart event
  bool accepts_ranges = false;                // ranges can be read without reading the bytes before them
  bool from_cache = false;                    // the server was not asked, or confirmed the cached version
  AddressSpace space = AddressSpace::global;  // space of the host that sent the document

  /// Returns the origin of the received document.
  [[nodiscard]] Origin origin() const { return {url, space}; }
};
/// Data event of a request. Each requested byte is delivered once. The bytes of one range are in order. If the server
/// does not support ranges, all bytes are in order.
struct LoadData {
  std::uint64_t offset = 0;  // offset of the first byte in the resource
  std::vector<std::byte> bytes;
};
/// Last event of a successful request: all requested bytes were delivered.
struct LoadDone {};
/// Event after a change of the resource, or after a transfer that cannot be resumed. All earlier data is invalid; a new
/// head follows.
struct LoadRestarted {};

/// Event of a request: a head, data, a restart, and success or error at the end. No event follows the end or a
/// cancellation.
struct LoadEvent {
  RequestId id;
  std::variant<LoadHead, LoadData, LoadDone, LoadRestarted, LoadError> what;
};

/// Limits, time-outs and environment of a loader.
struct LoaderOptions {
  // Maximum received bytes that were not polled. Above it, transfers wait; each may exceed it by one block.
  std::size_t max_queued_bytes = std::size_t{8} << 20;
  std::size_t max_queued_bytes_per_request = std::size_t{4} << 20;
  std::size_t max_header_bytes = std::size_t{64} << 10;
  std::size_t max_ranges = 4096;
  // Maximum concurrent transfers. A few more may be paused while transfers of higher priority run.
  unsigned max_transfers = 16;
  unsigned max_transfers_per_host = 6;
  std::uint64_t bytes_per_second = 0;  // total bandwidth of HTTP and FTP; 0 means unlimited
  std::uint64_t join_gap = 4096;       // ranges with a gap of fewer bytes are requested as one
  // Limits of redirects, retries and times.
  unsigned max_redirects = 10;
  unsigned max_retries = 3;  // retries of a fetch without progress
  // Retries without progress while a server that has answered breaks connections or cannot be reached, or if it asks
  // for a retry.
  unsigned max_reconnects = 6;
  unsigned max_attempts = 30;  // transfers of a fetch, even with progress
  unsigned max_restarts = 3;
  Milliseconds connect_timeout{10'000};
  Milliseconds head_timeout{30'000};   // from the start of a transfer to the end of the response's headers
  Milliseconds stall_timeout{20'000};  // maximum time without received bytes of the body
  Milliseconds retry_delay{250};       // doubled with each retry, then multiplied by a random factor from 0.5 to 1
  Milliseconds max_retry_delay{8'000};
  Milliseconds max_retry_after{15'000};  // if a server requests a longer delay, the request fails
  // Folder of the disk cache. If empty, nothing is cached.
  std::string cache_folder;
  std::uint64_t cache_bytes = std::uint64_t{2} << 30;
  std::size_t cache_entries = 4096;
  // Allowed references of documents.
  ReferencePolicy policy;
  AddressSpaceOf space_of = address_space_of;
  // Functions of the environment.
  std::function<void()> wake;                  // called on the loader's threads when poll() has new events
  std::function<std::uint64_t()> random;       // returns 64 random bits; called on the network thread only
  std::function<std::int64_t()> unix_seconds;  // time for the cache; called on the network thread only
  std::string user_agent = "GhostSpace";
  std::string remote_program = "ghostspace";               // as in remote_serve_command()
  std::function<void(const std::string& message)> report;  // receives messages of ssh; any thread; may be empty
  std::string ca_file;                 // file of trusted certificates; empty means the system's certificates
  bool proxy_from_environment = true;  // reads http_proxy, https_proxy and no_proxy
  // Makes the transport for memory: URLs. Called on the network thread. Null means that the scheme is not supported.
  std::function<std::unique_ptr<Transport>()> memory;
};

}  // namespace gs::net
