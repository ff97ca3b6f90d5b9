#!/usr/bin/env bash
# Tests the scripts in tools/ and toolchain/ without building or installing anything: scripts_test.sh CASE
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*" >&2; exit 1; }

# tools/run and tools/bench pass --help to the program that they build.
scripts=(tools/{console/build,deploy,estimate-arm,evaluate-all,lint,package,publishing-cost,setup,sysroot,test,test-arm,test-board,test-package}
         toolchain/{changed-files,debian-mirror,emulate-arm64})

EveryScriptHasHelp() {
  local script output code
  for script in "${scripts[@]}"; do
    output=$(cd "$work" && "$root/$script" --help </dev/null 2>&1) || fail "$script --help failed: $output"
    grep -qE "^Examples?: .*${script##*/}" <<<"$output" || fail "$script --help has no example: $output"
    ! grep -qE "^(set -|cd |[a-z_]+=)" <<<"$output" || fail "$script --help prints more than its header: $output"
    [[ $script == tools/evaluate-all || $script == tools/test-board || $script == tools/estimate-arm ]] && continue  # Python checks their options, after tools/setup
    code=0
    (cd "$work" && "$root/$script" --no-such-option </dev/null >/dev/null 2>"$work/errors") || code=$?
    [ "$code" -eq 64 ] || fail "$script --no-such-option: exit code $code instead of 64"
    [ -s "$work/errors" ] || fail "$script --no-such-option: nothing on standard error"
  done
}

# Prints the scripts among the arguments that use a compiler, an emulator or another package, but do not call tools/setup.
without_setup() {
  local script
  for script in "$@"; do
    if grep -qE '^[^#]*(cmake |ctest |clang-tidy |mmdebstrap |python3 )' "$script" && ! grep -qE '^[^#]*tools/setup' "$script"; then
      echo "$script"
    fi
  done
}

EveryScriptInstallsItsPackages() {
  cd "$root"
  local found
  found=$(without_setup tools/{bench,estimate-arm,lint,package,publishing-cost,run,test,test-arm,test-board,test-package})
  [ -z "$found" ] || fail "no call of tools/setup in $found"
  printf '#!/bin/sh\ncmake --preset release\n' >"$work/planted"
  [ "$(without_setup "$work/planted")" = "$work/planted" ] || fail "a script without tools/setup was not found"
}

# Copies tools/test to a folder where its commands are replaced. CMake fails for the preset $broken, CTest for the preset asan.
fake_repository() {
  mkdir -p "$work/tools/console" "$work/toolchain" "$work/bin" "$work/tests/network/javascript"
  cp "$root/tools/test" "$work/tools/"
  cp "$root/toolchain/use-ccache.sh" "$work/toolchain/"
  for script in tools/setup tools/console/build tools/test-arm tools/lint tests/network/javascript/run toolchain/changed-files bin/git bin/clang-format bin/ccache; do
    printf '#!/bin/sh\n' >"$work/$script"
  done
  cat >"$work/bin/cmake" <<'FAKE'
#!/bin/sh
[ "$1" != --build ] || [ "$3" != "$broken" ]
FAKE
  cat >"$work/bin/ctest" <<'FAKE'
#!/bin/bash
echo "$2" >>"$work/ctest-calls"
case " $* " in
  *second-run.log*)
    echo "together=${TOUCHLINE_TESTS_TOGETHER:-} $*" >"$work/second-call"
    exit "${second_try:-0}"
    ;;
esac
while [ "$1" != --output-log ]; do preset=${preset-$2}; shift; done
if [[ $2 == */real_time.log ]]; then
  mkdir -p "$(dirname "$2")/Testing/Temporary"
  touch "$(dirname "$2")/Testing/Temporary/LastTest.log"
  [ -n "$failing" ] || exit 0
  printf "%s\n" $failing >"$(dirname "$2")/Testing/Temporary/LastTestsFailed.log"
  exit 8
fi
mkdir -p "$(dirname "$2")"
if [ "$preset" = release ]; then
  cat >"$2" <<'LOG'
100% tests passed, 0 tests failed out of 900
The following tests did not run:
	 41 - Network.ProtobufjsReadsThePackets (Skipped)
LOG
  mkdir -p "$(dirname "$2")/Testing/Temporary"
  cat >"$(dirname "$2")/Testing/Temporary/LastTest.log" <<'LOG'
[  SKIPPED ] Sets/Arena.NeedsPictures/0, where GetParam() = r0 (0 ms)
[  SKIPPED ] 1 test, listed below:
[  SKIPPED ] Sets/Arena.NeedsPictures/0, where GetParam() = r0
LOG
fi
[ "$preset" = asan ] || exit 0
cat >"$2" <<'LOG'
3: [  FAILED  ] Pipeline.KeepsItsOrder (3 ms)
The following tests FAILED:
	  3 - pipeline_test.1 (Failed)
	  9 - Deploy.AFirstFrameCompletesTheDeployment (Timeout)
LOG
exit 8
FAKE
  chmod +x "$work"/bin/* "$work"/tools/* "$work/toolchain/changed-files" "$work/tools/console/build" "$work/tests/network/javascript/run"
  export work broken=${1:-none} PATH=$work/bin:$PATH
}

ASummaryNamesFailedTests() {
  fake_repository
  local code=0 output
  output=$("$work/tools/test" 2>&1) || code=$?
  [ "$code" -eq 1 ] || fail "exit code $code instead of 1: $output"
  for expected in 'FAILED .* tests with address' 'Pipeline.KeepsItsOrder$' 'pipeline_test.1$' 'Deploy.AFirstFrameCompletesTheDeployment$' \
                  'passed .* clang-tidy' 'passed .* tests that start threads' 'passed .* tests in real time'; do
    grep -qE "$expected" <<<"${output#*== summary}" || fail "the summary lacks $expected: $output"
  done
}

ASummaryNamesSkippedTests() {
  fake_repository
  local output
  printf '#!/bin/sh\nexit 1\n' | tee "$work/tools/console/build" >"$work/tests/network/javascript/run"
  output=$("$work/tools/test" --quick 2>&1) || fail "a skipped test is a failure: $output"
  grep -q 'protobufjs could not be installed' <<<"$output" || fail "protobufjs is missing without a word: $output"
  grep -q "console's page could not be built" <<<"$output" || fail "the page is missing without a word: $output"
  for expected in 'skipped: 2,' 'Network.ProtobufjsReadsThePackets$' 'Sets/Arena.NeedsPictures/0$'; do
    grep -qE "$expected" <<<"${output#*== summary}" || fail "the summary lacks $expected: $output"
  done
}

ATestInRealTimeThatFailsRunsAgain() {
  fake_repository
  local output
  # The sanitizers' tests do not matter here.
  sed -i 's/^\[ "$preset" = asan \] || exit 0$/exit 0/' "$work/bin/ctest"
  output=$(failing='9:Page.Program 3:Network.ExternalStrategy' "$work/tools/test" 2>&1) || fail "the second try did not count: $output"
  grep -qF -- '-R ^(Page.Program|Network.ExternalStrategy)$' "$work/second-call" || fail "it ran: $(cat "$work/second-call")"
  # A program's part (NAME.1) exists only among tests that run together.
  grep -q '^together=1 ' "$work/second-call" || fail "the second try has other names of tests: $(cat "$work/second-call")"
  grep -q 'passed only at the second try: Page.Program$' <<<"${output#*== summary}" || fail "the summary lacks it: $output"
  grep -q 'skipped: 2,' <<<"${output#*== summary}" || fail "the summary lacks what the first try skipped: $output"
  ! failing=9:Page.Program second_try=8 "$work/tools/test" >/dev/null 2>&1 || fail "two failures are a success"
}

AFailedBuildSkipsOnlyItsTests() {
  fake_repository release
  local output
  output=$("$work/tools/test" 2>&1) && fail "a failed build was not reported: $output"
  grep -qE 'FAILED .*build with gcc' <<<"$output" || fail "the summary lacks the build: $output"
  [ "$(cat "$work/ctest-calls")" = $'asan\ntsan' ] || fail "CTest ran for: $(cat "$work/ctest-calls")"
}

ChangedFilesAreThoseOfTheLastDayOrOfTheBranch() {
  mkdir -p "$work/toolchain"
  cp "$root/toolchain/changed-files" "$work/toolchain/"
  cd "$work"
  git init -q -b main
  # commit FILE DAY
  commit() {
    echo "$2" >>"$1"
    git add "$1"
    GIT_COMMITTER_DATE="2026-01-0$2T12:00:00Z" git -c user.name=test -c user.email=test@example.invalid commit -q -m "$1"
  }
  commit old.cpp 1
  ! toolchain/changed-files >/dev/null || fail "without history, everything may have changed"
  commit yesterday.cpp 3
  commit today.cpp 3
  touch uncommitted.cpp
  [ "$(toolchain/changed-files | grep cpp)" = $'today.cpp\nuncommitted.cpp\nyesterday.cpp' ] || fail "of the last day: $(toolchain/changed-files)"
  git update-ref refs/remotes/origin/main HEAD~1
  [ "$(toolchain/changed-files | grep cpp)" = $'today.cpp\nuncommitted.cpp' ] || fail "of the branch: $(toolchain/changed-files)"
  [ "$(TOUCHLINE_BASE=HEAD toolchain/changed-files | grep cpp)" = uncommitted.cpp ] || fail "since a named commit: $(toolchain/changed-files)"
}

# A machine where "apt-get update" never ran, such as a fresh container.
TheMirrorIsKnownBeforeAptUpdate() {
  mkdir -p "$work/bin"
  cat >"$work/bin/apt-get" <<'FAKE'
#!/bin/sh
case $3 in
  *ORIGIN*) printf '||http://mirror.invalid/debian/\n||http://mirror.invalid/debian-security/\n' ;;
  *) printf 'http://mirror.invalid/debian-security/\nhttp://mirror.invalid/debian/\n' ;;
esac
FAKE
  chmod +x "$work/bin/apt-get"
  local mirror
  mirror=$(env -u TOUCHLINE_MIRROR PATH="$work/bin:$PATH" "$root/toolchain/debian-mirror")
  [ "$mirror" = http://mirror.invalid/debian/ ] || fail "the mirror is '$mirror'"
}

# mmdebstrap refuses a foreign system that the kernel cannot run, even if it only downloads packages.
EmulationIsSetUpBeforeAForeignSystem() {
  cd "$root"
  local file first
  for file in tools/test-package tests/board/image.py; do
    first=$(grep -nE '^[^#]*(emulate-arm64"?\)?$|mmdebstrap --|"mmdebstrap",)' "$file" | head -n 1)
    [[ $first == *emulate-arm64* ]] || fail "$file calls mmdebstrap before emulate-arm64: $first"
  done
}

OneVersionNumber() {
  cd "$root"
  local version found
  version=$(sed -n 's/^project(touchline VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
  [ -n "$version" ] || fail "CMakeLists.txt has no version"
  found=$(grep -rlF --exclude-dir={build,dist,node_modules,.git} -e "$version" CMakeLists.txt core hal firmware tools toolchain docs README.md || true)
  [ "$found" = CMakeLists.txt ] || fail "the version $version is also in: $found"
}

"$1"
