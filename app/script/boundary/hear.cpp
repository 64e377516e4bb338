#include "app/script/boundary/hear.h"

namespace gs::app::script {

Heard hear(WorldAccess& world, std::span<const std::byte> message, MessageWriter& answer, Report& report) {
  MessageReader reader(message);
  while (!reader.at_end()) {
    switch (static_cast<ItemKind>(reader.number<std::uint8_t>())) {
      case ItemKind::notice: {
        const Notice notice = read_notice(reader);
        if (!reader.good()) return Heard::impossible;
        world.tell(notice);
        break;
      }
      case ItemKind::question: {
        const Question question = read_question(reader);
        if (!reader.good() || !reader.at_end()) return Heard::impossible;
        answer.clear();
        write(answer, world.ask(question));
        return Heard::question;
      }
      case ItemKind::report:
        report = read_report(reader);
        return reader.good() && reader.at_end() ? Heard::report : Heard::impossible;
      default:
        return Heard::impossible;
    }
  }
  return reader.good() ? Heard::notices : Heard::impossible;
}

}  // namespace gs::app::script
