// Responses by functions of the program: to POST requests, and for content that does not exist in the folder.
#include "net/serve/http_site.h"

#include <utility>

namespace gs::net {

HttpSite::Reply HttpSite::post(const HttpRequest& request) const {
  if (request.has_body) return problem(413, "the request has a body; expected none");
  const auto [path, query] = split_target(request.target);
  PostAnswer result{0, {}, request.later};
  if (!result.later) result = options_.post({path, query, request.authorization});
  if (!result.later) return problem(result.status, result.message);
  if (const auto answer = result.later()) return problem(answer->status, answer->message);
  if (request.waited_long) return problem(504, "has not been confirmed; retry later");
  return WaitForMade{kPostLane, {}, options_.content_wait, {}, std::move(result.later)};
}

std::optional<HttpSite::Reply> HttpSite::content(const HttpRequest& request, const RequestPath& path) const {
  if (!options_.content) return std::nullopt;
  ContentRequest wanted{{}, request.within};
  for (const std::string& part : path.names) wanted.path += (wanted.path.empty() ? "" : "/") + part;
  if (path.folder) wanted.path += '/';
  HeldContent held = options_.content(wanted);
  switch (held.state) {
    case HeldContent::State::none:
      break;
    case HeldContent::State::waiting:
      if (request.method == "HEAD") return problem(202, "is being generated; retry later");
      if (request.waited_long) return problem(503, "is not ready; retry later");
      return WaitForMade{kContentLane, {}, options_.content_wait, std::move(wanted)};
    case HeldContent::State::gone:
      return problem(410, "is no longer available; load the newest version");
    case HeldContent::State::ready:
      return text(request, held.mime, std::move(held.body));
  }
  return std::nullopt;
}

}  // namespace gs::net
