#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the commands of the tables in this folder, each in its own folder with a copy of the same small files, and checks
# exit status and messages. No command may crash, hang, or print an internal error. Exit 1 if a row fails.
#   tests/adversary/run.sh PROGRAM [PATTERN]     only rows whose name contains PATTERN
set -uo pipefail
tables="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
program="$(realpath "$1")"
pattern="${2:-}"
work="$(mktemp -d)"
trap 'chmod -R u+rwX "$work"; rm -rf "$work"' EXIT
chmod 755 "$work"

time_limit=180  # seconds per row: only a hang takes as long, also on a busy machine
# Text that only a failure of the program itself prints.
forbidden=('exception' 'what()' 'terminate called' 'std::' 'internal error' 'Segmentation fault' 'Aborted' '[json.')
states=(missing empty folder binary huge pipe unreadable)  # the last one changes the owner of all files
rows=0 failed=0 skipped=0

mkdir "$work/bin" && ln -s "$program" "$work/bin/stillpoint"
# As root, permissions mean nothing: commands on unreadable files run as an unprivileged user.
as_user=()
if ((EUID == 0)); then
  as_user=(setpriv --reuid=65534 --regid=65534 --clear-groups)
  "${as_user[@]}" "$work/bin/stillpoint" --version >/dev/null 2>&1 || as_user=(unavailable)
fi

# execute FOLDER COMMAND [PREFIX...]: sets `status` and `text`, the output of both streams
execute() {
  local folder="$1" command="$2"
  shift 2
  (cd "$folder" && env -i PATH="$work/bin:$PATH" HOME="$folder" LC_ALL=C.UTF-8 "$@" \
    timeout --kill-after=1 "$time_limit" bash -c "$command") </dev/null >"$work/text" 2>&1
  status=$?
  { text="$(<"$work/text")"; } 2>/dev/null # without the warning that null bytes are left out
}

make_fixtures() {
  fixtures="$work/fixtures"
  mkdir "$fixtures"
  execute "$fixtures" '
    set -e
    awk "BEGIN {for (i = 0; i < 200; ++i) {t = i / 20; print t, cos(t), sin(t), 0.1 * t, 0, 0, 0, 1}}" >gt.tum
    awk "{\$2 += 0.01 * sin(7 * \$1)} 1" gt.tum >est.tum
    awk "{print 1, 0, 0, \$2, 0, 1, 0, \$3, 0, 0, 1, \$4}" gt.tum >kitti.txt
    mkdir gt results; { echo "seq: 1"; cat gt.tum; } >gt/gt_office_1.txt; cp gt.tum gt.onnx
    small="--seconds 2.5 --rate 10 --width 320 --height 240"
    stillpoint data synth walking_xyz $small --out seq
    printf "variants = [\"stillpoint\", \"dynamic_vins\"]\nimages = 0\nrecorded.sequences = [\"./seq\"]\n" >plan.toml
    stillpoint bench plan.toml --store store.sqlite --out table || test $? = 1
    stillpoint store export runs.json --store store.sqlite'
  ((status == 0)) || { echo "the files for the commands cannot be created: $text"; exit 1; }
}

fail() { # NAME COMMAND PROBLEM
  failed=$((failed + 1))
  printf 'FAILED %s\n  %s\n  %s\n%s\n' "$1" "$2" "$3" "$(tail -n 4 <<<"$text" | cut -c 1-400 | sed 's/^/  > /')"
}

# expect NAME EXIT WORDS COMMAND: checks the result of `execute`
expect() {
  local name="$1" exit="$2" words="$3" command="$4" word
  rows=$((rows + 1))
  ((status != 124 && status != 137)) || { fail "$name" "$command" "no result after $time_limit s"; return; }
  [[ "$status" == "$exit" ]] || { fail "$name" "$command" "exit status $status, expected $exit"; return; }
  for word in "${forbidden[@]}"; do
    [[ "$text" != *"$word"* ]] || { fail "$name" "$command" "prints \"$word\""; return; }
  done
  while read -r word; do
    case "$word" in
      '') ;;
      '!'*) [[ "$text" != *"${word:1}"* ]] || { fail "$name" "$command" "prints \"${word:1}\""; return; } ;;
      *) [[ "$text" == *"$word"* ]] || { fail "$name" "$command" "does not print \"$word\""; return; } ;;
    esac
  done <<<"${words//;/$'\n'}"
}

run_table() { # FILE
  local line name exit words command
  while IFS= read -r line; do
    [[ -n "$line" && "$line" != '#'* ]] || continue
    name="${line%% | *}" line="${line#* | }"
    exit="${line%% | *}" line="${line#* | }"
    words="${line%% | *}" command="${line#* | }"
    [[ "$name" == *"$pattern"* ]] || continue
    cp -r "$fixtures" "$work/case"
    execute "$work/case" "$command"
    expect "$name" "$exit" "$words" "$command"
    rm -rf "$work/case"
  done <"$1"
}

make_input() { # STATE FILE
  case "$1" in
    missing) ;;
    empty) : >"$2" ;;
    folder) mkdir "$2" ;;
    unreadable) echo text >"$2" && chmod 000 "$2" ;;
    binary) head -c 5000 "$program" >"$2" ;;
    huge) truncate -s 1T "$2" 2>/dev/null || truncate -s 15G "$2" ;;
    pipe) mkfifo "$2" ;;
  esac
}

# run_input COMMAND EXCEPTIONS: one row per state of the input. The states share a folder, so that the next one finds
# what a rejected command leaves behind.
run_input() {
  local template="$1" exceptions="$2" state exception expected command file prefix words
  command="${template/@/input}"
  [[ "$template" =~ @([.a-z]*) ]]
  file="$work/case/input${BASH_REMATCH[1]}"
  cp -r "$fixtures" "$work/case"
  for state in "${states[@]}"; do
    expected=2 words=input
    for exception in $exceptions; do [[ "$exception" != "$state="* ]] || expected="${exception#*=}"; done
    [[ "$expected" == 2 ]] || words=""
    [[ "$expected" != - && "$state: $command" == *"$pattern"* ]] || continue
    [[ "$state" != pipe || "$exceptions" == *pipe* ]] || continue
    prefix=()
    [[ "$state" != unreadable ]] || prefix=("${as_user[@]}")
    [[ "${prefix[*]}" != unavailable ]] || { skipped=$((skipped + 1)); continue; }
    make_input "$state" "$file"
    ((${#prefix[@]} == 0)) || chown -R 65534:65534 "$work/case"
    execute "$work/case" "$command" "${prefix[@]}"
    expect "$state: $template" "$expected" "$words" "$command"
    rm -rf "$file"*
  done
  rm -rf "$work/case"
}

run_inputs() { # FILE
  local line
  while IFS= read -r line; do
    [[ -n "$line" && "$line" != '#'* ]] || continue
    run_input "${line%% |*}" "${line##*|}"
  done <"$1"
}

make_fixtures
for table in command_line evaluation plans stores sequences; do run_table "$tables/$table.txt"; done
run_inputs "$tables/inputs.txt"
((skipped == 0)) ||
  echo "$skipped rows on unreadable files skipped: as root, they require setpriv and a program that other users can execute"
echo "adversary: $rows rows, $failed failed, $SECONDS s"
((failed == 0))
