#include "net/transfer/curl_failures.h"

namespace gs::net {

std::string milliseconds(Milliseconds time) { return std::to_string(time.count()) + " ms"; }

TransferEnd describe_failure(CURLcode code, const std::string& detail, const LoaderOptions& options) {
  const auto end = [&](LoadErrorKind kind, const std::string& what, bool transient) {
    return TransferEnd{LoadError{kind, detail.empty() ? what : what + " (" + detail + ")", 0}, transient};
  };
  switch (code) {
    case CURLE_URL_MALFORMAT:
      return end(LoadErrorKind::bad_request, "the URL is malformed; expected http://host/path", false);
    case CURLE_COULDNT_RESOLVE_HOST:
    case CURLE_COULDNT_RESOLVE_PROXY:
      return end(LoadErrorKind::unreachable, "no such host", false);
    case CURLE_COULDNT_CONNECT:
      return end(LoadErrorKind::unreachable, "the server cannot be reached", false);
    case CURLE_OPERATION_TIMEDOUT:
      return end(LoadErrorKind::timed_out, "no connection within " + milliseconds(options.connect_timeout), true);
    case CURLE_PEER_FAILED_VERIFICATION:
    case CURLE_SSL_CONNECT_ERROR:
    case CURLE_SSL_CERTPROBLEM:
    case CURLE_SSL_CIPHER:
    case CURLE_SSL_CACERT_BADFILE:
    case CURLE_SSL_ISSUER_ERROR:
      return end(LoadErrorKind::insecure, "the certificate of the server is not valid", false);
    case CURLE_UNSUPPORTED_PROTOCOL:
    case CURLE_WEIRD_SERVER_REPLY:
      return end(LoadErrorKind::bad_response, "the server does not speak HTTP", false);
    case CURLE_REMOTE_FILE_NOT_FOUND:
    case CURLE_REMOTE_ACCESS_DENIED:
    case CURLE_FTP_COULDNT_RETR_FILE:
      return end(LoadErrorKind::not_found, "the server has no such file, or does not permit access", false);
    case CURLE_LOGIN_DENIED:
      return end(LoadErrorKind::http_status, "the server requires a user name and password", false);
    case CURLE_FTP_WEIRD_PASS_REPLY:
    case CURLE_FTP_WEIRD_PASV_REPLY:
    case CURLE_FTP_WEIRD_227_FORMAT:
    case CURLE_FTP_CANT_GET_HOST:
    case CURLE_FTP_COULDNT_SET_TYPE:
      return end(LoadErrorKind::bad_response, "the server does not speak FTP", false);
    case CURLE_BAD_CONTENT_ENCODING:
      return end(LoadErrorKind::bad_response, "the compressed body is damaged", false);
    case CURLE_OUT_OF_MEMORY:
      return end(LoadErrorKind::too_large, "a block of the body decompresses to more than the limit", false);
    case CURLE_GOT_NOTHING:
      return end(LoadErrorKind::broken, "the server closed the connection without an answer", true);
    default:
      return end(LoadErrorKind::broken, "the connection was interrupted", true);
  }
}

}  // namespace gs::net
