#!/usr/bin/env bash
# Tests the files of the .deb other than the programs, without a package and without root: package_test.sh CASE [ARGUMENTS]
set -euo pipefail
package=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../toolchain/package" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*"; exit 1; }

# A folder takes the place of the board. Fakes record the commands that the package's scripts call and do nothing.
export DPKG_ROOT=$work/board PATH=$work/fakes:$PATH
etc=$DPKG_ROOT/etc/touchline boards=$DPKG_ROOT/usr/share/touchline/boards
mkdir -p "$work/fakes" "$boards" "$DPKG_ROOT/run/systemd/system" "$DPKG_ROOT/run/udev" "$DPKG_ROOT/etc"
touch "$DPKG_ROOT/run/udev/control"
cp -r "$package/../../boards/mock" "$boards/"
for program in getent addgroup adduser udevadm systemctl deb-systemd-invoke; do
  printf '#!/bin/sh\necho %s "$*" >>"%s"\n[ ! -e "%s/no-$1" ]\n' "$program" "$work/called" "$work" >"$work/fakes/$program"
done
printf '#!/bin/sh\necho touchline video\n' >"$work/fakes/id"
chmod +x "$work"/fakes/*
script() { sh "$package/$1" "${@:2}" >"$work/output"; }
called() { grep -qxF -- "$1" "$work/called"; }

case $1 in
  FilesAreCopiedOnceAndKept)
    script postinst configure ""
    for file in board.toml venue.toml team.toml venue-light.png venue-field.png; do cmp "$boards/mock/$file" "$etc/$file"; done
    [ "$(find "$etc" -type f | wc -l)" = 5 ] || fail "other files than these were copied"
    grep -q "built-in arena" "$work/output" || fail "does not report what it copied"
    called "adduser --quiet touchline gpio" || fail "not in the group gpio"
    ! called "adduser --quiet touchline video" || fail "added to a group again"
    called "deb-systemd-invoke try-restart touchline.service touchline-setup.service" || fail "the new programs do not run"
    echo "the hall's own" >"$etc/venue.toml"
    rm "$etc/team.toml"
    script postinst configure ""
    script postinst configure 0.1.0
    script prerm upgrade 0.2.0
    script postrm upgrade 0.2.0
    script prerm remove
    script postrm remove
    [ "$(cat "$etc/venue.toml")" = "the hall's own" ] || fail "the venue file has changed"
    [ ! -e "$etc/team.toml" ] || fail "a file that the team removed was copied again"
    ;;
  ABoardGetsNoTools)
    # $2: the build. Its components are the packages touchline and touchline-tools. The rest: an emulator for its programs, if they need one.
    files() { cmake --install "$1" --component "$2" --prefix "$work/components/$2" >"$work/output" && (cd "$work/components/$2" && find . -type f | sort); }
    files "$2" board >"$work/board-files"
    files "$2" tools >"$work/tools-files"
    programs=$(sed -n 's~^./bin/~~p' "$work/board-files" | xargs)
    [ "$programs" = "touchline touchline-calibrate touchline-devices touchline-setup" ] || fail "touchline contains $programs"
    programs=$(sed -n 's~^./bin/~~p' "$work/tools-files" | xargs)
    [ "$programs" = "touchline-arena touchline-control touchline-evaluate touchline-latency touchline-log touchline-radio touchline-rectify touchline-relight touchline-replay touchline-simulate" ] ||
      fail "touchline-tools contains $programs"
    [ -z "$(comm -12 "$work/board-files" "$work/tools-files")" ] || fail "in both packages: $(comm -12 "$work/board-files" "$work/tools-files")"
    # All that is installed is in one of the packages.
    cmake --install "$2" --prefix "$work/all" >"$work/output"
    (cd "$work/all" && find . -type f | sort) | diff - <(sort "$work/board-files" "$work/tools-files") || fail "a file is in neither package"
    # FFmpeg's libraries come with touchline-tools.
    for program in "$work"/components/board/bin/*; do
      readelf -d "$program" >"$work/dynamic"
      grep -q 'NEEDED.*libc\.so' "$work/dynamic" || fail "cannot list the libraries of ${program##*/}"
      ! grep -E 'NEEDED.*\[lib(av|sw)' "$work/dynamic" || fail "${program##*/} needs FFmpeg"
    done
    # Programs find the module for videos where it is installed, and say what is missing without it. The video has no frame.
    echo "YUV4MPEG2 W16 H16 F25:1 C420mpeg2" >"$work/match.y4m"
    open_video() { ! "${@:2}" "$1/bin/touchline-calibrate" noise "$work/match.y4m" --venue "$boards/mock/venue.toml" --team "$boards/mock/team.toml" 2>"$work/output"; }
    open_video "$work/components/board" "${@:3}"
    grep -q "match.y4m: is not a picture .* the package touchline-tools" "$work/output" || fail "does not name the missing package: $(cat "$work/output")"
    open_video "$work/all" "${@:3}"
    grep -q "match.y4m: contains no frame" "$work/output" || fail "does not find the module: $(cat "$work/output")"
    ;;
  AnInterruptedFirstInstallationIsCompleted)
    printf '#!/bin/sh\ncase $1 in *team.toml) echo half >"$2"; exit 1 ;; esac\nexec %s "$@"\n' "$(command -v cp)" >"$work/fakes/cp"
    chmod +x "$work/fakes/cp"
    if script postinst configure ""; then fail "a failure is not reported"; fi
    rm "$work/fakes/cp"
    script postinst configure ""
    for file in board.toml venue.toml team.toml venue-light.png venue-field.png; do cmp "$boards/mock/$file" "$etc/$file"; done
    [ "$(find "$etc" -type f | wc -l)" = 5 ] || fail "a partial file is left"
    ;;
  AFailedRemovalRestartsTheService)
    script prerm remove
    called "deb-systemd-invoke stop touchline.service touchline-setup.service" || fail "not stopped"
    script postinst abort-remove
    for service in touchline touchline-setup; do
      called "deb-systemd-invoke start $service.service" || fail "$service is not started again"
    done
    [ ! -e "$etc" ] || fail "files were copied"
    # A service that is not enabled was not running.
    rm "$work/called"
    touch "$work/no---quiet"
    script postinst abort-remove
    for service in touchline touchline-setup; do
      ! called "deb-systemd-invoke start $service.service" || fail "$service is started though it is not enabled"
    done
    ;;
  PurgingLeavesNothing)
    script postinst configure ""
    mkdir -p "$DPKG_ROOT/var/lib/touchline" "$DPKG_ROOT/var/cache/touchline" "$DPKG_ROOT/etc/systemd/system/multi-user.target.wants"
    ln -s nowhere "$DPKG_ROOT/etc/systemd/system/multi-user.target.wants/touchline.service"
    script postrm purge
    script postrm purge
    [ -z "$(find "$DPKG_ROOT" -path "$DPKG_ROOT/usr" -prune -o -name '*touchline*' -print)" ] || fail "files are left"
    ;;
  RulesApplyToDevicesThatArePluggedInAlready)
    script postinst configure ""
    called "udevadm control --reload" || fail "the rules are not read"
    mapfile -t subsystems < <(grep -o 'SUBSYSTEM=="[^"]*"' "$package/touchline.rules" | cut -d '"' -f 2 | sort -u)
    [ ${#subsystems[@]} -ge 5 ] || fail "rules for ${subsystems[*]} only"
    for subsystem in "${subsystems[@]}"; do
      grep "^udevadm trigger" "$work/called" | grep -qE -- "--subsystem-match=$subsystem( |\$)" || fail "$subsystem is not triggered"
    done
    # udevadm trigger sends the action "change".
    ! grep -q 'ACTION=="add"' "$package/touchline.rules" || fail "a rule applies only to devices that are plugged in later"
    ;;
  OnlyATaggedAdapterIsTheRadio)
    # Other serial adapters keep their names, and ModemManager may use them.
    mapfile -t rules < <(grep -E '^[^#].*(touchline/radio|ID_MM_)' "$package/touchline.rules")
    [ ${#rules[@]} -ge 1 ] || fail "no rule names the radio"
    for rule in "${rules[@]}"; do
      [[ $rule == *'SUBSYSTEM=="tty"'*'ENV{TOUCHLINE_RADIO}=="1"'* ]] || fail "applies to every adapter: $rule"
    done
    grep -q 'ENV{TOUCHLINE_RADIO}="1"' "$package/../../docs/deploy.md" || fail "docs/deploy.md does not say how to tag an adapter"
    ;;
  TheServiceUnitIsValid)
    # $2: systemd-analyze. Another program replaces Touchline; the rest is the delivered unit.
    sed 's|^ExecStart=.*|ExecStart=/bin/true|; /^Documentation=/d' "$package/touchline.service" >"$work/touchline.service"
    output=$("$2" verify "$work/touchline.service" 2>&1) && [ -z "$output" ] || fail "$output"
    # The exposure that systemd-analyze computes must be 1.5 of 10 at most.
    "$2" security --offline=true --threshold=15 --no-pager "$work/touchline.service" >"$work/output" || fail "$(tail -n 1 "$work/output")"
    for line in WatchdogSec=5 Type=notify LimitRTPRIO=99 LimitMEMLOCK=infinity User=touchline ProtectSystem=strict DevicePolicy=closed \
      'RestartPreventExitStatus=1 64' StartLimitIntervalSec=0 StateDirectory=touchline RuntimeDirectory=touchline \
      RuntimeDirectoryPreserve=restart LimitDATA=512M MemoryMax=768M TasksMax=64; do
      grep -qxF "$line" "$package/touchline.service" || fail "$line is missing"
    done
    ;;
  TheSetupUnitPermitsToGiveUpItsCapability)
    # $2: systemd-analyze. The calibrations of tools/programs/setup/worker.cpp do so first of all, and end if they cannot. Later lines of
    # SystemCallFilter add calls and, with ~, remove them.
    members() { [[ $1 != @* ]] || "$2" syscall-filter "$1" | sed -n 's/^ \+\([@a-z]\)/\1/p'; [[ $1 == @* ]] || echo "$1"; }
    permits() {
      local entry
      for entry in $(members "$1" "$3"); do
        if [[ $entry == @* ]] && permits "$entry" "$2" "$3" || [ "$entry" = "$2" ]; then return 0; fi
      done
      return 1
    }
    for unit in touchline-setup.service planted; do
      grep -v '^SystemCallFilter=capset' "$package/touchline-setup.service" >"$work/planted"
      file=$package/$unit
      [ -e "$file" ] || file=$work/$unit
      is_permitted=no
      while read -r filter; do
        for entry in ${filter#\~}; do
          if permits "$entry" capset "$2"; then [[ $filter == \~* ]] && is_permitted=no || is_permitted=yes; fi
        done
      done < <(sed -n 's/^SystemCallFilter=//p' "$file")
      [ $is_permitted = "$([ "$unit" = planted ] && echo no || echo yes)" ] || fail "$unit: capset is permitted: $is_permitted"
    done
    ;;
  ManualPage)
    # $2: the program's name; the rest: the program, after its emulator if it needs one. The page must contain all options of --help.
    name=$2
    "$package/man-page" "$name" 1.2.3 "$work/page.gz" "${@:3}"
    gunzip -c "$work/page.gz" | sed 's/\\-/-/g' >"$work/page"
    grep -qE "^$name - ." "$work/page" || fail "no name and summary"
    grep -qE "^\.B $name( |\$)" "$work/page" || fail "the synopsis does not begin with the program's name"
    ! grep -nF "$(dirname "${@: -1}")" "$work/page" || fail "names this machine's folders"
    "${@:3}" --help | grep -oE -- '--[a-z][a-z-]+' | sort -u >"$work/options"
    [ -s "$work/options" ] || fail "no options"
    while IFS= read -r option; do
      grep -qF -- "$option" "$work/page" || fail "$option is missing"
    done <"$work/options"
    ;;
  *) fail "no such case: $1" ;;
esac
