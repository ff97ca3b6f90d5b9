declare const PAGE_VERSION: string; // put in by vite.config.ts

/** The version of Touchline that this page was built with. */
export const pageVersion = PAGE_VERSION;
