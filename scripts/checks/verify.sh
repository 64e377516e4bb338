# Sourced by the check scripts. Counts failures in $failures.
failures=0
verify() { # WHAT EXPECTED FOUND
  if [ "$2" = "$3" ]; then
    echo "ok: $1"
  else
    echo "WRONG: $1: expected '$2', found '$3'"
    failures=$((failures + 1))
  fi
}
