# Prints violations of the writing rules of docs/style.md, one per line: RULE, ROOM, FILE:LINE: TEXT, separated by tabs. Reads C++ sources
# and README files; `tables` set to 1 treats every file as a README. Consecutive comment lines count as one comment.

FNR == 1 {
  flush()
  room = FILENAME
  if (!sub(/\/.*/, "", room)) room = "root"
  readme = FILENAME ~ /README\.md$/ || tables
  aligned = 0
}

readme {
  if ($0 ~ /^\|/) check_cells($0)
  next
}

/TEST_CASE\("/ {
  title = $0
  sub(/.*TEST_CASE\("/, "", title)
  sub(/"[^"]*$/, "", title)
  lower = tolower(title)
  if (lower ~ OPENING || lower ~ RESULT || lower ~ WHO || lower ~ LIKEWISE) report("title", FNR, title)
}

{
  at = index($0, "//")
  if (at && $0 ~ /["']/) {
    code = $0
    gsub(/\\./, "..", code)  # equally long, so that columns stay right
    while (match(code, /"[^"]*"/)) code = substr(code, 1, RSTART - 1) blank(RLENGTH) substr(code, RSTART + RLENGTH)
    at = index(code, "//")
  }
  if (!at) {
    flush()
    aligned = 0
    next
  }
  text = substr($0, at)
  sub(/^\/\/+<? ?/, "", text)
  alone = substr($0, 1, at - 1) ~ /^[ \t]*$/
  if (text == "" && alone) {  # an empty comment line separates paragraphs
    flush()
    next
  }
  if (alone && block != "" && at == aligned) {
    block = block " " text
  } else {
    flush()
    block = text
    first = FNR
    block_file = FILENAME
    block_room = room
  }
  aligned = at
}

END { flush() }

BEGIN {
  OPENING = "^(what|of what|where|who|whose|likewise)([^a-z_]|$)"
  RESULT = "(^|[.;:,)] +)(nothing|false|null):"
  WHO = "(^|[^a-z_'`])(who|whose)([^a-z_]|$)"
  LIKEWISE = "(^|[^a-z_])likewise([^a-z_]|$)"
}

function blank(length_of,   s) {
  while (length(s) < length_of) s = s " "
  return s
}

function report(rule, line, text) { print rule "\t" room "\t" FILENAME ":" line ": " text }

function flush(   lower) {
  if (block == "") return
  lower = tolower(block)
  if (lower ~ OPENING) emit("opening")
  if (lower ~ RESULT) emit("result")
  if (lower ~ LIKEWISE) emit("likewise")
  if (lower ~ WHO) emit("who")
  block = ""
}

# Reports the collected comment. FILENAME may already be the next file.
function emit(rule) { print rule "\t" block_room "\t" block_file ":" first ": " substr(block, 1, 100) }

function check_cells(row,   cells, count, i, words) {
  gsub(/\\\|/, "/", row)
  count = split(row, cells, "|")
  for (i = 2; i < count; ++i)
    if ((words = split(cells[i], unused, /[ \t]+/) - (cells[i] ~ /^[ \t]/) - (cells[i] ~ /[ \t]$/)) > 40)
      report("cell", FNR, words " words:" substr(cells[i], 1, 80))
}
