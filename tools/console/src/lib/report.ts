import type { EventLine, Hello, Status } from './protocol';

/** The report that can be downloaded, as JSON. Times are the board's. */
export function makeReport(hello: Hello | null, status: Status | null, events: readonly EventLine[], samples: readonly unknown[]): string {
  const description = hello && { ...hello, projection: undefined };
  return JSON.stringify({ report: 'touchline console', made_s: status?.time_s ?? null, hello: description, status, latency_of_last_minute: samples, events }, null, 2);
}

/** "touchline-mock-20261123-150702.json"; characters that are not letters or digits become dashes. */
export function reportName(hello: Hello | null, status: Status | null): string {
  const board = (hello?.board ?? 'board').replace(/[^a-zA-Z0-9]+/g, '-').slice(0, 40);
  const time = status ? new Date(status.time_s * 1000).toISOString().replace(/[-:]/g, '').replace('T', '-').slice(0, 15) : 'no-data';
  return `touchline-${board}-${time}.json`;
}

/** The file name in a header Content-Disposition. */
export function bugReportName(disposition: string | null): string {
  return disposition?.match(/filename="([\w.-]+)"/)?.[1] ?? 'touchline-bug-report.tar.gz';
}
