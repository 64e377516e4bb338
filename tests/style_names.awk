# Prints names in anonymous namespaces that occur in two files of one room, as ROOM NAMESPACE NAME: FILES. Such names clash in
# unity builds. Reads .cpp files. Finds types, constants, and functions with equal first lines.
function note(name,  key) {
  key = room SUBSEP space SUBSEP name
  if (!(key in first)) { first[key] = FILENAME; return }
  if (first[key] == FILENAME || seen[key, FILENAME]++) return
  others[key] = others[key] " " FILENAME
}
{ previous = current; current = $0 }
FNR == 1 {
  inside = 0
  space = ""
  split(FILENAME, parts, "/")
  room = parts[1] == "tests" ? parts[1] "/" parts[2] : parts[1]
}
/^namespace \{$/ { inside = 1; next }
/^\}  \/\/ namespace$/ { inside = 0; next }
/^namespace [A-Za-z_:]+ \{/ { space = $2; next }
/^using namespace / { space = space " " $3; next }
!inside { next }
/^(inline |static )*const(expr|init)? / {
  rest = $0
  while (match(rest, /[ *&]k[A-Z][A-Za-z0-9]*(\[[^]]*\])? = /)) {
    name = substr(rest, RSTART + 1, RLENGTH - 1)
    sub(/[^A-Za-z0-9].*/, "", name)
    note(name)
    rest = substr(rest, RSTART + RLENGTH)
  }
}
/^(class|struct|enum class|enum) [A-Za-z]+ [^;]*\{/ { note($1 == "enum" && $2 == "class" ? $3 : $2) }
/^[A-Za-z].*\) (const )?(\{|\{.*\})$/ && !/^(template|static_assert|TEST_CASE|extern)/ && previous !~ /^template/ {
  line = $0
  sub(/ \{.*/, "", line)
  note(line)
}
END {
  for (key in others) {
    split(key, of, SUBSEP)
    print of[1], of[2], of[3] ": " first[key] others[key]
  }
}
